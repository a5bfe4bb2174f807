/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/display.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include "daemon/clock.h"

#define SECOND UINT64_C(1000000000)
#define FIRST_DELAY (SECOND / 4)
#define LAST_DELAY (8 * SECOND)
/* A presenter that is lost sooner than this after it was made has not helped. */
#define GOOD_LIFE (2 * SECOND)
/* Main waits no longer than this for the user of a presenter. */
#define PATIENCE (3 * SECOND)

/* A presenter and what was heard of it. */
struct slot {
	struct display *display;
	struct presenter *presenter;
	struct clock_spinning clock; /* the presenter's */
	struct settings settings;    /* that it was made with, and whose strings it keeps */
	bool lost;                   /* with the display's lock, as the sentence */
	char sentence[256];
};

struct display {
	struct display_params params;
	struct settings settings;
	struct slot slots[2];
	struct slot *now, *next; /* in use, NULL none; told to the user in its place, mostly NULL */
	struct {
		struct settings settings;
		struct slot *slot; /* made for them, not in use yet; NULL: it needs none */
		bool replaced;     /* the one in use was made for them, in place of another */
		bool changes;      /* they concern presenters at all */
	} prepared;
	struct loop_source *presenter_source, *wake_source, *retry_source;
	int wake_fd, retry_fd;
	uint64_t made_ns, delay_ns;
	bool taken_away; /* the user was told, and has not answered */
	bool promised;   /* the user has none, and was told that there will be another */

	pthread_mutex_t lock; /* for what other threads say */
	pthread_cond_t said;
	bool let_go;
};

static void wake(struct display *display)
{
	const uint64_t one = 1;
	/* A full counter wakes just as well. */
	if (write(display->wake_fd, &one, sizeof(one)) < 0 && errno != EAGAIN)
		log_error(display->params.log, "eventfd: %s", strerror(errno));
}

/* On any thread. */
static void on_lost(void *data, const char *sentence)
{
	struct slot *slot = data;
	struct display *display = slot->display;
	pthread_mutex_lock(&display->lock);
	if (!slot->lost)
		snprintf(slot->sentence, sizeof(slot->sentence), "%s", sentence);
	slot->lost = true;
	pthread_mutex_unlock(&display->lock);
	wake(display);
}

/* On main: what is made next is another one. */
static void on_failed(void *data)
{
	struct slot *slot = data;
	pthread_mutex_lock(&slot->display->lock);
	slot->lost = false;
	pthread_mutex_unlock(&slot->display->lock);
}

void display_let_go(struct display *display)
{
	pthread_mutex_lock(&display->lock);
	display->let_go = true;
	pthread_cond_signal(&display->said);
	pthread_mutex_unlock(&display->lock);
	wake(display);
}

static void on_flip(void *data, const struct presenter_flip *flip)
{
	const struct slot *slot = data;
	slot->display->params.flip(slot->display->params.data, slot->presenter, flip);
}

static void on_key(void *data, const struct presenter_key *key)
{
	struct display *display = ((struct slot *)data)->display;
	display->params.key(display->params.data, key);
}

static void on_presenter_event(void *data, uint32_t events)
{
	struct display *display = data;
	(void)events;
	display->now->presenter->impl->process_events(display->now->presenter);
}

/* ---- making one ---- */

/* An engine that is to run elsewhere cannot use it. */
static bool may_share_gl(const struct settings *settings)
{
	return !settings->gles && (strcmp(settings->context, "auto") == 0 || strcmp(settings->context, "egl") == 0);
}

static struct presenter_params params_for(const struct display *display, struct slot *slot)
{
	const struct settings *settings = &slot->settings;
	return (struct presenter_params){
		.clock = &slot->clock.clock,
		.log = display->params.log,
		.refresh_numerator = settings->refresh_numerator,
		.refresh_denominator = settings->refresh_denominator,
		.options = {.monitor = settings->monitor,
					.fullscreen = settings->fullscreen,
					.width = settings->window_width,
					.height = settings->window_height,
					.connector = settings->connector,
					.mode = settings->mode,
					.device = settings->kms_device,
					.share_gl = may_share_gl(settings)},
		.flip = on_flip,
		.lost = on_lost,
		.failed = on_failed,
		.key = on_key,
		.data = slot,
		.vsync = display->params.vsync,
	};
}

/* Of the one before nothing is heard any more. */
static struct slot *free_slot(struct display *display, const struct settings *settings)
{
	struct slot *slot = &display->slots[display->now == &display->slots[0]];
	pthread_mutex_lock(&display->lock);
	*slot = (struct slot){.display = display, .settings = *settings};
	clock_init_spinning(&slot->clock, display->params.clock, (uint64_t)settings->spin_us * 1000);
	pthread_mutex_unlock(&display->lock);
	return slot;
}

/* The delay until those before it in the list are looked for, or all if there is none. */
static void try_later(struct display *display)
{
	const uint64_t delay_ns = display->delay_ns ? display->delay_ns : 1;
	const struct itimerspec when = {
		.it_value = {(time_t)(delay_ns / SECOND), (long)(delay_ns % SECOND)},
	};
	timerfd_settime(display->retry_fd, 0, &when, NULL);
}

static void longer_delay(struct display *display)
{
	display->delay_ns = display->delay_ns ? display->delay_ns * 2 : FIRST_DELAY;
	if (display->delay_ns > LAST_DELAY)
		display->delay_ns = LAST_DELAY;
}

static void look_later(struct display *display)
{
	if (!presenter_has_better(display->settings.present, display->now->presenter->impl))
		return;
	longer_delay(display);
	try_later(display);
}

/* The user knows it. */
static void adopt(struct display *display, struct slot *slot)
{
	const struct presenter_impl *impl = slot->presenter->impl;
	display->now = slot;
	display->made_ns = clock_now(display->params.clock);
	if (impl->get_event_fd)
		display->presenter_source =
			loop_add(display->params.loop, impl->get_event_fd(slot->presenter), EPOLLIN, on_presenter_event, display);
	look_later(display);
	/* It may be lost already. */
	wake(display);
}

static void use(struct display *display, struct slot *slot)
{
	display->promised = false;
	display->params.change(display->params.data, slot->presenter, false);
	adopt(display, slot);
}

static int use_first_that_works(struct display *display, struct error *error)
{
	struct slot *slot = free_slot(display, &display->settings);
	const struct presenter_params params = params_for(display, slot);
	slot->presenter = presenter_create(display->settings.present, &params, error);
	if (!slot->presenter)
		return -ENODEV;
	use(display, slot);
	return 0;
}

/* `next` in its place, NULL none. */
static void take_away(struct display *display, struct slot *next, bool lost)
{
	display->taken_away = true;
	display->next = next;
	display->promised = !next && !lost;
	loop_remove(&display->presenter_source);
	display->params.change(display->params.data, next ? next->presenter : NULL, lost);
}

/* One that stands before the one in use. */
static void look_for_better(struct display *display)
{
	struct slot *slot = free_slot(display, &display->settings);
	const struct presenter_params params = params_for(display, slot);
	const struct presenter_impl *impl = display->now->presenter->impl;
	slot->presenter = presenter_create_better(display->settings.present, impl, &params);
	if (slot->presenter) {
		log_info(display->params.log, "%s works again and takes over from %s", slot->presenter->impl->name, impl->name);
		take_away(display, slot, false);
		return;
	}
	longer_delay(display);
	try_later(display);
}

static void on_retry(void *data, uint32_t events)
{
	struct display *display = data;
	struct error error = {""};
	uint64_t count;
	(void)events;
	if (read(display->retry_fd, &count, sizeof(count)) < 0)
		return;
	if (display->now) {
		if (!display->taken_away)
			look_for_better(display);
		return;
	}
	if (use_first_that_works(display, &error) == 0) {
		log_info(display->params.log, "%s presents now", display->now->presenter->impl->name);
		return;
	}
	longer_delay(display);
	log_warning(display->params.log, "no presenter works; the next attempt is in %u ms",
				(unsigned)(display->delay_ns / 1000000));
	try_later(display);
}

/* ---- losing one ---- */

static void destroy_now(struct display *display)
{
	presenter_destroy(&display->now->presenter);
	display->now = NULL;
	display->taken_away = false;
	pthread_mutex_lock(&display->lock);
	display->let_go = false;
	pthread_mutex_unlock(&display->lock);
}

/* Nobody knows when there will be one. */
static void take_promise_back(struct display *display)
{
	if (display->promised)
		display->params.change(display->params.data, NULL, true);
	display->promised = false;
}

static void bury(struct display *display)
{
	struct slot *next = display->next;
	const bool good = clock_now(display->params.clock) - display->made_ns > GOOD_LIFE;
	destroy_now(display);
	display->next = NULL;
	if (next) {
		adopt(display, next);
		log_info(display->params.log, "%s presents now", next->presenter->impl->name);
		return;
	}
	take_promise_back(display);
	if (good)
		display->delay_ns = 0;
	else
		longer_delay(display);
	try_later(display);
}

static void on_wake(void *data, uint32_t events)
{
	struct display *display = data;
	char sentence[sizeof(display->slots[0].sentence)] = "";
	uint64_t count;
	(void)events;
	if (read(display->wake_fd, &count, sizeof(count)) < 0)
		return;
	pthread_mutex_lock(&display->lock);
	const bool lost = display->now && display->now->lost, let_go = display->let_go;
	if (lost)
		memcpy(sentence, display->now->sentence, sizeof(sentence));
	pthread_mutex_unlock(&display->lock);
	if (lost && !display->taken_away) {
		log_warning(display->params.log, "%s is lost: %s", display->now->presenter->impl->name, sentence);
		take_away(display, NULL, true);
	} else if (let_go && display->taken_away) {
		bury(display);
	}
}

/* ---- other settings ---- */

/* Has the user let go of the one that was taken away? */
static bool wait_for_user(struct display *display)
{
	const uint64_t until_ns = clock_monotonic_ns() + PATIENCE;
	pthread_mutex_lock(&display->lock);
	while (!display->let_go && clock_cond_wait(&display->said, &display->lock, until_ns))
		;
	const bool let_go = display->let_go;
	pthread_mutex_unlock(&display->lock);
	return let_go;
}

static bool settle(struct display *display)
{
	if (!display->taken_away)
		return true;
	if (!wait_for_user(display))
		return false;
	bury(display);
	return true;
}

/* Presenters of this kind. */
static bool concerns(enum presenter_kind kind, const struct settings *a, const struct settings *b)
{
	if (a->refresh_numerator != b->refresh_numerator || a->refresh_denominator != b->refresh_denominator ||
		a->spin_us != b->spin_us)
		return true;
	switch (kind) {
	case PRESENTER_MEMORY:
		return false;
	case PRESENTER_WINDOW:
		return strcmp(a->monitor, b->monitor) != 0 || a->fullscreen != b->fullscreen ||
			   a->window_width != b->window_width || a->window_height != b->window_height ||
			   may_share_gl(a) != may_share_gl(b);
	case PRESENTER_DEVICE:
		return strcmp(a->connector, b->connector) != 0 || strcmp(a->mode, b->mode) != 0 ||
			   strcmp(a->kms_device, b->kms_device) != 0 || may_share_gl(a) != may_share_gl(b);
	}
	return false;
}

/* Any presenter. */
static bool concerns_any(const struct settings *a, const struct settings *b)
{
	return strcmp(a->present, b->present) != 0 || concerns(PRESENTER_WINDOW, a, b) || concerns(PRESENTER_DEVICE, a, b);
}

/* The one in use goes first; if no other can be made it comes back. Both with settings of their own. */
static int replace(struct display *display, const struct settings *fresh, struct error *error)
{
	const struct settings before = display->now->settings;
	const struct presenter_impl *impl = display->now->presenter->impl;
	take_away(display, NULL, false);
	if (!wait_for_user(display))
		return error_set(error, -ETIMEDOUT, "present: %s is in use still and cannot be made anew", impl->name);
	destroy_now(display);
	struct slot *slot = free_slot(display, fresh);
	struct presenter_params params = params_for(display, slot);
	slot->presenter = presenter_create(impl->name, &params, error);
	const int result = slot->presenter ? 0 : -ENODEV;
	if (result < 0) {
		struct error again;
		slot = free_slot(display, &before);
		params = params_for(display, slot);
		slot->presenter = presenter_create(impl->name, &params, &again);
	}
	if (slot->presenter) {
		use(display, slot);
	} else {
		take_promise_back(display);
		try_later(display);
	}
	return result;
}

/* Beside what there is: one of the list, if it need not be the one in use. Its slot stays empty if there is none. */
static int prepare_another(struct display *display, const struct settings *fresh, struct error *error)
{
	const struct presenter_impl *impl = display->now ? display->now->presenter->impl : NULL;
	struct slot *slot = free_slot(display, fresh);
	const struct presenter_params params = params_for(display, slot);
	slot->presenter = presenter_create_before(fresh->present, impl, &params, error);
	display->prepared.slot = slot->presenter ? slot : NULL;
	return slot->presenter || (impl && presenter_is_listed(fresh->present, impl)) ? 0 : -ENODEV;
}

/* The one in use anew. */
static int prepare_same(struct display *display, const struct settings *fresh, struct error *error)
{
	const struct presenter_impl *impl = display->now->presenter->impl;
	if (impl->kind != PRESENTER_MEMORY) {
		const int result = replace(display, fresh, error);
		display->prepared.replaced = result == 0;
		return result;
	}
	struct slot *slot = free_slot(display, fresh);
	const struct presenter_params params = params_for(display, slot);
	slot->presenter = presenter_create(impl->name, &params, error);
	display->prepared.slot = slot->presenter ? slot : NULL;
	return slot->presenter ? 0 : -ENODEV;
}

int display_prepare(struct display *display, const struct settings *fresh, struct error *error)
{
	int result = 0;
	display->prepared.slot = NULL;
	display->prepared.replaced = false;
	display->prepared.changes = concerns_any(&display->settings, fresh);
	/* Whatever state it is in: others' settings can be taken over. */
	if (!display->prepared.changes)
		return 0;
	if (!settle(display))
		return error_set(error, -ETIMEDOUT, "present: the presenter before this one is in use still");
	display->prepared.settings = *fresh;
	if (!display->now || strcmp(fresh->present, display->settings.present) != 0)
		result = prepare_another(display, fresh, error);
	if (result == 0 && display->now && !display->prepared.slot &&
		concerns(display->now->presenter->impl->kind, &display->settings, fresh))
		result = prepare_same(display, fresh, error);
	return result;
}

void display_commit(struct display *display)
{
	struct slot *slot = display->prepared.slot;
	if (!display->prepared.changes)
		return;
	display->settings = display->prepared.settings;
	display->prepared.slot = NULL;
	if (slot && display->now) {
		take_away(display, slot, false);
		settle(display);
	} else if (slot) {
		use(display, slot);
	} else if (display->now && !display->taken_away) {
		look_later(display);
	}
}

void display_abandon(struct display *display)
{
	struct error error;
	if (display->prepared.slot)
		presenter_destroy(&display->prepared.slot->presenter);
	else if (display->prepared.replaced && settle(display) && display->now &&
			 replace(display, &display->settings, &error) < 0)
		log_warning(display->params.log, "%s", error.text);
	display->prepared.slot = NULL;
}

/* ---- life ---- */

static int start(struct display *display, struct error *error)
{
	display->wake_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	display->retry_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	if (display->wake_fd >= 0)
		display->wake_source = loop_add(display->params.loop, display->wake_fd, EPOLLIN, on_wake, display);
	if (display->retry_fd >= 0)
		display->retry_source = loop_add(display->params.loop, display->retry_fd, EPOLLIN, on_retry, display);
	if (!display->wake_source || !display->retry_source)
		return error_set(error, -errno, "display: out of memory or file descriptors");
	return use_first_that_works(display, error);
}

struct display *display_create(const struct display_params *params, struct error *error)
{
	struct display *display = calloc(1, sizeof(*display));
	if (!display) {
		error_set(error, -ENOMEM, "display: out of memory");
		return NULL;
	}
	display->params = *params;
	display->settings = *params->settings;
	display->wake_fd = display->retry_fd = -1;
	pthread_mutex_init(&display->lock, NULL);
	clock_cond_init(&display->said);
	if (start(display, error) < 0)
		display_destroy(&display);
	return display;
}

void display_destroy(struct display **display)
{
	struct display *self = *display;
	*display = NULL;
	if (!self)
		return;
	loop_remove(&self->presenter_source);
	loop_remove(&self->wake_source);
	loop_remove(&self->retry_source);
	for (size_t i = 0; i < sizeof(self->slots) / sizeof(self->slots[0]); i++)
		presenter_destroy(&self->slots[i].presenter);
	if (self->wake_fd >= 0)
		close(self->wake_fd);
	if (self->retry_fd >= 0)
		close(self->retry_fd);
	pthread_cond_destroy(&self->said);
	pthread_mutex_destroy(&self->lock);
	free(self);
}

/* NULL: there is none that stays. */
static struct presenter *presenter_of(const struct display *display)
{
	return display->now && !display->taken_away ? display->now->presenter : NULL;
}

void display_get_trouble(struct display *display, char *text, size_t size)
{
	struct presenter *presenter = presenter_of(display);
	if (!presenter || !presenter->impl->get_trouble || !presenter->impl->get_trouble(presenter, text, size))
		text[0] = 0;
}

void display_toggle_fullscreen(struct display *display)
{
	struct presenter *presenter = presenter_of(display);
	if (presenter && presenter->impl->toggle_fullscreen)
		presenter->impl->toggle_fullscreen(presenter);
}
