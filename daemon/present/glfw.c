/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The GLFW presenter: a window, or full screen, on a desktop. The window has a
 * thread of its own for its events; a thread here, the keeper of vblanks, takes
 * the picture of each one out of the queue and orders it from the drawing
 * thread, whose swaps may wait for the display as long as they like. One that
 * does not come back in time leaves the keeper counting vblanks by the clock;
 * after some of those in a row (a window that nobody sees, which the window
 * system does not say) no vblank waits for its swap any more, until they are
 * quick again.
 *
 * Where swaps wait for the display, its vblanks are learned from their time
 * stamps; where they do not (no vsync), vblanks are those of the rate wished
 * for, and pictures are drawn at their times. With an external vsync (vsync.h)
 * vblanks are its own there, and swaps that wait without a stamp are dated back
 * to them.
 */
#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "daemon/present/drawer.h"
#include "daemon/present/pictures.h"
#include "daemon/present/vblanks.h"
#include "daemon/present/vsync.h"

#define MS UINT64_C(1000000)
#define LEAST_LEAD (MS + MS / 2)
/* Swaps in a row that tell whether they wait for the display. */
#define PROBE_SWAPS 12u
#define PROBE_NS (500 * MS)
#define STUCK_NS (500 * MS)
/* Swaps in a row: so many that did not come back leave the clock alone, so many quick ones are waited for again. */
#define MISSING_SWAPS 8u
#define QUICK_SWAPS 30u
/* A display server that has not answered for so long hangs; this often is looked whether. */
#define SILENCE_NS (1000 * MS)
#define SILENCE_LOOK_NS 500000000l

struct glfw {
	struct pictures pictures; /* its lock is for what follows, unless it says otherwise */
	struct window *window;
	pthread_t keeper;
	struct window_state state;

	/* main's own */
	int timer_fd;
	bool silence_said;

	atomic_bool open, lost; /* its user knows it, and wants to hear of its loss; it is lost */

	/* the render thread's own; the context does not change */
	struct presenter_context context;
	bool has_context, has_functions;
	struct texture_functions functions;

	/* the keeper's own */
	struct drawer *drawer;
	bool fitted;                          /* the window knows the size of the first picture */
	bool under_way, stuck_said, by_clock; /* by_clock: no vblank waits for its swap */
	uint32_t missing, quick;              /* swaps in a row */
	uint64_t ordered_ns;
	uint32_t image;        /* under way, referenced; FLIPS_IMAGES: none */
	uint64_t drawn_serial; /* of the picture ordered last; 0: black */
	uint32_t drawn_changes, probed_displays;
	bool waits_for_display; /* swaps do */
	struct vblanks vblanks;
	struct vblanks returns; /* as the returns of swaps alone have them */
	uint64_t first_vblank;  /* vblank 0 of `vblanks` */
	uint32_t skipped;       /* since the last flip */
};

/* ---- the keeper: orders ---- */

/* With the lock. Orders the front, or black. */
static void order(struct glfw *self, uint32_t swaps)
{
	struct pictures *pictures = &self->pictures;
	const struct flips *flips = &pictures->flips;
	self->image = flips->has_front ? flips->front.image : FLIPS_IMAGES;
	if (flips->has_front)
		pictures->flips.references[self->image]++;
	self->under_way = true;
	self->ordered_ns = clock_now(pictures->params.clock);
	self->drawn_changes = self->state.changes;
	self->drawn_serial = flips->has_front ? flips->front.serial : 0;
	drawer_order(self->drawer, flips->has_front ? &pictures->shapes[self->image] : NULL, self->state.width,
				 self->state.height, swaps);
}

/* With the lock, which is given up while it waits. False: not back yet. */
static bool wait_for_order(struct glfw *self, uint64_t until_ns, struct drawer_swap *swap)
{
	struct pictures *pictures = &self->pictures;
	if (!self->under_way)
		return true;
	pthread_mutex_unlock(&pictures->lock);
	const bool done = drawer_wait(self->drawer, until_ns, swap);
	pthread_mutex_lock(&pictures->lock);
	if (!done) {
		if (!self->stuck_said && clock_now(pictures->params.clock) - self->ordered_ns > STUCK_NS) {
			log_info(pictures->params.log,
					 "glfw: a swap does not come back; vblanks are counted by the clock until then");
			self->stuck_said = true;
		}
		return false;
	}
	if (self->image < FLIPS_IMAGES)
		flips_release(&pictures->flips, self->image);
	self->under_way = self->stuck_said = false;
	return true;
}

/* Was the last swap back in time? */
static void judge_swap(struct glfw *self, bool back)
{
	self->missing = back ? 0 : self->missing + 1;
	self->quick = back ? self->quick + 1 : 0;
	if (!self->by_clock && self->missing >= MISSING_SWAPS) {
		log_info(self->pictures.params.log,
				 "glfw: swaps take too long; vblanks do not wait for them until they are quick");
		self->by_clock = true;
	} else if (self->by_clock && self->quick >= QUICK_SWAPS) {
		log_info(self->pictures.params.log, "glfw: swaps are quick again");
		self->by_clock = false;
		/* Its vblanks went on meanwhile. */
		if (self->waits_for_display)
			self->probed_displays = self->state.displays - 1;
	}
}

/* With the lock: may it draw now? */
static bool can_draw(struct glfw *self)
{
	struct drawer_swap swap;
	const bool was_under_way = self->under_way;
	if (!wait_for_order(self, 0, &swap))
		return false;
	if (was_under_way && self->by_clock)
		judge_swap(self, (double)(swap.time_ns - self->ordered_ns) < 1.5 * grid_period_ns(&self->pictures.grid));
	return !self->state.hidden;
}

/* Does the window show something else? A front that came while a swap was under way was not ordered then. */
static bool is_due(const struct glfw *self)
{
	const struct flips *flips = &self->pictures.flips;
	const uint64_t serial = flips->has_front ? flips->front.serial : 0;
	return serial != self->drawn_serial || self->state.changes != self->drawn_changes;
}

/* ---- the keeper: the display's rate ---- */

static void set_lead(struct glfw *self, uint64_t drawing_ns)
{
	struct pictures *pictures = &self->pictures;
	const uint64_t most = (uint64_t)(0.7 * grid_period_ns(&pictures->grid));
	const uint64_t lead = LEAST_LEAD + 2 * drawing_ns;
	if (!self->waits_for_display)
		pictures->lead_ns = 0;
	else if (pictures->lead_ns < lead)
		pictures->lead_ns = lead < most ? lead : most;
	else
		pictures->lead_ns -= (pictures->lead_ns - lead) / 64;
}

static void adopt_vblanks(struct glfw *self)
{
	self->pictures.grid = vblanks_get_grid(&self->vblanks);
	self->pictures.grid.epoch_vblank += self->first_vblank;
}

/* Vblanks are counted anew, their numbers go on. */
static void begin_grid(struct glfw *self, double refresh_hz)
{
	struct pictures *pictures = &self->pictures;
	const uint64_t now_ns = clock_now(pictures->params.clock);
	self->first_vblank = grid_at_or_after(&pictures->grid, now_ns) + 1;
	if (self->first_vblank < pictures->next_vblank)
		self->first_vblank = pictures->next_vblank;
	if (self->waits_for_display)
		vblanks_init(&self->vblanks, (uint64_t)(refresh_hz * 1e3 + 0.5), 1000, now_ns);
	else
		vblanks_init(&self->vblanks, pictures->params.refresh_numerator, pictures->params.refresh_denominator, now_ns);
	self->returns = self->vblanks;
	adopt_vblanks(self);
}

/* With the lock: finds out by some swaps in a row whether they wait for the display. */
static void probe(struct glfw *self)
{
	struct pictures *pictures = &self->pictures;
	struct drawer_swap swap = {.time_ns = 0};
	const double mode_hz = self->state.refresh_hz;
	self->probed_displays = self->state.displays;
	order(self, PROBE_SWAPS);
	const bool back = wait_for_order(self, clock_now(pictures->params.clock) + PROBE_NS, &swap);
	const double hz = back && swap.interval_ns ? 1e9 / (double)swap.interval_ns : 0.0;
	const bool waits = mode_hz > 0.0 && hz > 0.6 * mode_hz && hz < 1.5 * mode_hz;
	const bool other = waits || self->waits_for_display;
	self->waits_for_display = waits;
	if (mode_hz > 0.0)
		vsync_expect(pictures->params.vsync, 1e9 / mode_hz);
	if (other)
		begin_grid(self, mode_hz);
	set_lead(self, swap.drawing_ns);
	if (self->waits_for_display)
		log_info(pictures->params.log, "glfw: swaps wait for the display, at about %.2f Hz; time stamps: %s", hz,
				 presenter_time_source_name(swap.source));
	else
		log_info(pictures->params.log,
				 "glfw: swaps do not wait for the display (%.0f a second, its mode says %.0f Hz): shown by the clock",
				 hz, mode_hz);
}

/* ---- the keeper: vblanks ---- */

/* With the lock: where swaps wait for the display its vblanks come from them. */
static bool follow_vsync(struct glfw *self)
{
	struct pictures *pictures = &self->pictures;
	return !self->waits_for_display && pictures_follow_vsync(pictures, clock_now(pictures->params.clock));
}

/* With the lock: what the swap says about the flip and the display. */
static void note_swap(struct glfw *self, const struct drawer_swap *swap, struct presenter_flip *flip)
{
	struct pictures *pictures = &self->pictures;
	const bool skipped_its_own = flip->late;
	flip->flip_ns = swap->time_ns;
	flip->sequence = swap->sequence;
	flip->time_source = swap->source;
	flip->late |= swap->time_ns >= grid_time(&pictures->grid, flip->vblank + 1);
	if (!self->waits_for_display)
		return;
	vblanks_add(&self->returns, 0, swap->time_ns);
	if (swap->source == PRESENTER_TIME_ESTIMATED &&
		vsync_date_back(pictures->params.vsync, &self->returns, &flip->flip_ns, &flip->sequence))
		flip->time_source = PRESENTER_TIME_EXTERNAL;
	const uint64_t vblank = self->first_vblank + vblanks_add(&self->vblanks, flip->sequence, flip->flip_ns);
	adopt_vblanks(self);
	set_lead(self, swap->drawing_ns);
	flip->late = skipped_its_own || vblank > flip->vblank;
	if (vblank >= pictures->next_vblank) {
		self->skipped = (uint32_t)(vblank + 1 - pictures->next_vblank);
		pictures->next_vblank = vblank + 1;
	}
}

/* With the lock: the vblank next_vblank, from the choice of its picture to its flip event. */
static void keep_vblank(struct glfw *self)
{
	struct pictures *pictures = &self->pictures;
	struct drawer_swap swap;
	const bool by_vsync = follow_vsync(self);
	struct presenter_flip flip = pictures_show_next(pictures, clock_now(pictures->params.clock));
	flip.skipped += self->skipped;
	self->skipped = 0;
	flip.time_source = PRESENTER_TIME_TIMER;
	if (is_due(self) && can_draw(self)) {
		order(self, 1);
		if (!self->by_clock) {
			const bool back = wait_for_order(self, grid_time(&pictures->grid, flip.vblank + 2), &swap);
			judge_swap(self, back);
			if (back)
				note_swap(self, &swap, &flip);
		}
	}
	const bool is_first = !self->fitted && pictures->flips.has_front && pictures->flips.front.group > 0;
	const struct presenter_image shape =
		is_first ? pictures->shapes[pictures->flips.front.image] : (struct presenter_image){.data = NULL};
	self->fitted |= is_first;
	pthread_mutex_unlock(&pictures->lock);
	if (is_first)
		window_fit(self->window, shape.width, shape.height);
	if (flip.time_source == PRESENTER_TIME_TIMER) {
		clock_wait_until(pictures->params.clock, flip.target_ns);
		flip.flip_ns = clock_now(pictures->params.clock);
		flip.late |= flip.flip_ns >= flip.target_ns + (uint64_t)grid_period_ns(&pictures->grid);
		if (by_vsync && !flip.late) {
			flip.time_source = PRESENTER_TIME_EXTERNAL;
			flip.flip_ns = flip.target_ns;
		}
	}
	pictures->params.flip(pictures->params.data, &flip);
	pthread_mutex_lock(&pictures->lock);
}

/* With the lock: nothing is shown; the window may have to be drawn anew. */
static void keep_still(struct glfw *self)
{
	struct pictures *pictures = &self->pictures;
	struct drawer_swap swap;
	const bool due = is_due(self);
	if (due && can_draw(self))
		order(self, 1);
	if (due && self->under_way)
		wait_for_order(self, clock_now(pictures->params.clock) + PROBE_NS, &swap);
	else
		pthread_cond_wait(&pictures->wake, &pictures->lock);
}

static void *run(void *data)
{
	struct glfw *self = data;
	struct pictures *pictures = &self->pictures;
	pthread_setname_np(pthread_self(), "pursuit-flip");
	prctl(PR_SET_TIMERSLACK, 1ul, 0, 0, 0);
	pthread_mutex_lock(&pictures->lock);
	while (!pictures->stop) {
		if (self->state.displays != self->probed_displays && can_draw(self)) {
			probe(self);
			continue;
		}
		if (!pictures->running) {
			keep_still(self);
			continue;
		}
		follow_vsync(self);
		const uint64_t vblank = pictures->next_vblank;
		const uint64_t start_ns = grid_time(&pictures->grid, vblank) - pictures->lead_ns;
		pthread_mutex_unlock(&pictures->lock);
		clock_wait_until(pictures->params.clock, start_ns);
		pthread_mutex_lock(&pictures->lock);
		if (!pictures->stop && pictures->running && pictures->next_vblank == vblank)
			keep_vblank(self);
	}
	pthread_mutex_unlock(&pictures->lock);
	return NULL;
}

/* ---- the window's thread ---- */

static void on_key(void *data, uint32_t code)
{
	struct glfw *self = data;
	const struct presenter_key key = {code, clock_now(self->pictures.params.clock)};
	self->pictures.params.key(self->pictures.params.data, &key);
}

static void on_changed(void *data, const struct window_state *state)
{
	struct glfw *self = data;
	pthread_mutex_lock(&self->pictures.lock);
	self->state = *state;
	pthread_cond_signal(&self->pictures.wake);
	pthread_mutex_unlock(&self->pictures.lock);
}

static void on_lost(void *data, const char *sentence)
{
	struct glfw *self = data;
	atomic_store(&self->lost, true);
	if (atomic_exchange(&self->open, false))
		self->pictures.params.lost(self->pictures.params.data, sentence);
}

/* ---- main ---- */

/* Nobody draws any more. */
static void free_rest(void *data)
{
	struct glfw *self = data;
	window_destroy(&self->window);
	pictures_finish(&self->pictures);
	free(self);
}

static void free_glfw(struct glfw *self)
{
	const struct log *log = self->pictures.params.log;
	if (self->timer_fd >= 0)
		close(self->timer_fd);
	if (self->window)
		window_mute(self->window);
	if (drawer_destroy(&self->drawer, free_rest, self)) {
		free_rest(self);
		return;
	}
	log_warning(log, "glfw: a swap hangs; its window is left behind until it does not");
	window_leave_at_exit();
}

static int open_timer(struct glfw *self, struct error *error)
{
	const struct itimerspec often = {{0, SILENCE_LOOK_NS}, {0, SILENCE_LOOK_NS}};
	self->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	if (self->timer_fd < 0 || timerfd_settime(self->timer_fd, 0, &often, NULL) < 0)
		return error_set(error, -errno, "glfw: no timer: %s", strerror(errno));
	return 0;
}

static int open_all(struct glfw *self, struct error *error)
{
	const struct presenter_params *params = &self->pictures.params;
	const struct window_params window_params = {
		.log = params->log,
		.options = &params->options,
		.refresh_hz = (double)params->refresh_numerator / (double)params->refresh_denominator,
		.key = on_key,
		.changed = on_changed,
		.lost = on_lost,
		.data = self,
	};
	if (open_timer(self, error) < 0)
		return -EMFILE;
	self->window = window_create(&window_params, error);
	if (!self->window)
		return -ENODEV;
	self->has_context = window_get_context(self->window, &self->context);
	self->drawer = drawer_create(self->window, error);
	if (!self->drawer || drawer_wait_for_start(self->drawer, error) < 0)
		return -EIO;
	if (atomic_load(&self->lost))
		return error_set(error, -EIO, "glfw: the display server went away");
	const int result = pthread_create(&self->keeper, NULL, run, self);
	return result == 0 ? 0 : error_set(error, -result, "glfw: cannot start a thread: %s", strerror(result));
}

/* From now on its loss is told. */
static struct presenter *open_to_user(struct glfw *self)
{
	atomic_store(&self->open, true);
	if (atomic_load(&self->lost))
		on_lost(self, "glfw: the display server went away");
	return &self->pictures.presenter;
}

static struct presenter *glfw_create(const struct presenter_params *params, struct error *error)
{
	struct glfw *self = calloc(1, sizeof(*self));
	if (!self) {
		error_set(error, -ENOMEM, "glfw: out of memory");
		return NULL;
	}
	self->timer_fd = -1;
	pictures_init(&self->pictures, &presenter_glfw, params);
	if (open_all(self, error) == 0)
		return open_to_user(self);
	free_glfw(self);
	return NULL;
}

static void glfw_destroy(struct presenter *presenter)
{
	struct glfw *self = (struct glfw *)presenter;
	pthread_mutex_lock(&self->pictures.lock);
	self->pictures.stop = true;
	pthread_cond_signal(&self->pictures.wake);
	pthread_mutex_unlock(&self->pictures.lock);
	pthread_join(self->keeper, NULL);
	free_glfw(self);
}

static int glfw_get_event_fd(struct presenter *presenter)
{
	return ((struct glfw *)presenter)->timer_fd;
}

/* A server that does not answer is told of as long as it does not. */
static void glfw_process_events(struct presenter *presenter)
{
	struct glfw *self = (struct glfw *)presenter;
	const struct log *log = self->pictures.params.log;
	uint64_t count;
	if (read(self->timer_fd, &count, sizeof(count)) < 0)
		return;
	const bool silent = window_silence_ns(self->window) > SILENCE_NS;
	if (silent && !self->silence_said)
		log_warning(log, "glfw: the display server does not answer; vblanks are counted by the clock until it does");
	else if (!silent && self->silence_said && !atomic_load(&self->lost))
		log_info(log, "glfw: the display server answers again");
	self->silence_said = silent;
}

static bool glfw_get_trouble(struct presenter *presenter, char *text, size_t size)
{
	const uint64_t silence_ns = window_silence_ns(((struct glfw *)presenter)->window);
	if (silence_ns > SILENCE_NS)
		snprintf(text, size, "the display server has not answered for %.1f s", (double)silence_ns * 1e-9);
	return silence_ns > SILENCE_NS;
}

static bool glfw_is_possible(const struct presenter_params *params)
{
	(void)params;
	return window_is_possible();
}

static const struct presenter_context *glfw_get_context(struct presenter *presenter)
{
	struct glfw *self = (struct glfw *)presenter;
	return self->has_context ? &self->context : NULL;
}

static int glfw_acquire_texture(struct presenter *presenter, uint32_t width, uint32_t height,
								struct presenter_image *image)
{
	struct glfw *self = (struct glfw *)presenter;
	if (!self->has_functions)
		self->has_functions = texture_find_functions(&self->functions, self->context.find);
	return self->has_functions ? pictures_acquire_texture(&self->pictures, &self->functions, width, height, image)
							   : -ENOSYS;
}

static void glfw_toggle_fullscreen(struct presenter *presenter)
{
	window_toggle_fullscreen(((struct glfw *)presenter)->window);
}

const struct presenter_impl presenter_glfw = {
	.name = "glfw",
	.description = "a window, or full screen, on a desktop",
	.kind = PRESENTER_WINDOW,
	.is_possible = glfw_is_possible,
	.create = glfw_create,
	.destroy = glfw_destroy,
	.get_grid = pictures_get_grid,
	.get_lead = pictures_get_lead,
	.acquire = pictures_acquire,
	.get_context = glfw_get_context,
	.acquire_texture = glfw_acquire_texture,
	.release = pictures_release,
	.present = pictures_present,
	.set_standby = pictures_set_standby,
	.clear_standby = pictures_clear_standby,
	.pause = pictures_pause,
	.get_event_fd = glfw_get_event_fd,
	.process_events = glfw_process_events,
	.get_trouble = glfw_get_trouble,
	.toggle_fullscreen = glfw_toggle_fullscreen,
};
