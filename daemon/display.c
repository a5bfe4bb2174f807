/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/display.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#define SECOND UINT64_C(1000000000)
#define FIRST_DELAY (SECOND / 4)
#define LAST_DELAY (8 * SECOND)
/* A presenter that is lost sooner than this after it was made has not helped. */
#define GOOD_LIFE (2 * SECOND)

/* A presenter and what was heard of it. */
struct slot {
	struct display *display;
	struct presenter *presenter;
	bool lost; /* with the display's lock, as the sentence */
	char sentence[256];
};

struct display {
	struct display_params params;
	struct clock_spinning clock; /* the presenters' */
	struct slot slots[2];
	struct slot *now, *next; /* in use, NULL none; better than it, to be used as soon as that is gone, mostly NULL */
	struct loop_source *presenter_source, *wake_source, *retry_source;
	int wake_fd, retry_fd;
	uint64_t made_ns, delay_ns;
	bool taken_away; /* the user was told, and has not answered */

	pthread_mutex_t lock; /* for what other threads say */
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
	pthread_mutex_unlock(&display->lock);
	wake(display);
}

static void on_flip(void *data, const struct presenter_flip *flip)
{
	struct display *display = ((struct slot *)data)->display;
	display->params.flip(display->params.data, flip);
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

static struct presenter_params params_for(struct display *display, struct slot *slot)
{
	const struct settings *settings = display->params.settings;
	return (struct presenter_params){
		.clock = &display->clock.clock,
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
static struct slot *free_slot(struct display *display)
{
	struct slot *slot = &display->slots[display->now == &display->slots[0]];
	pthread_mutex_lock(&display->lock);
	*slot = (struct slot){.display = display};
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

static void use(struct display *display, struct slot *slot)
{
	const struct presenter_impl *impl = slot->presenter->impl;
	display->now = slot;
	display->made_ns = clock_now(display->params.clock);
	if (impl->get_event_fd)
		display->presenter_source =
			loop_add(display->params.loop, impl->get_event_fd(slot->presenter), EPOLLIN, on_presenter_event, display);
	display->params.change(display->params.data, slot->presenter);
	if (presenter_has_better(display->params.settings->present, impl)) {
		longer_delay(display);
		try_later(display);
	}
	/* It may be lost already. */
	wake(display);
}

static int use_first_that_works(struct display *display, struct error *error)
{
	struct slot *slot = free_slot(display);
	const struct presenter_params params = params_for(display, slot);
	slot->presenter = presenter_create(display->params.settings->present, &params, error);
	if (!slot->presenter)
		return -ENODEV;
	use(display, slot);
	return 0;
}

static void take_away(struct display *display)
{
	display->taken_away = true;
	loop_remove(&display->presenter_source);
	display->params.change(display->params.data, NULL);
}

/* One that stands before the one in use. */
static void look_for_better(struct display *display)
{
	struct slot *slot = free_slot(display);
	const struct presenter_params params = params_for(display, slot);
	const struct presenter_impl *impl = display->now->presenter->impl;
	slot->presenter = presenter_create_better(display->params.settings->present, impl, &params);
	if (slot->presenter) {
		log_info(display->params.log, "%s works again and takes over from %s", slot->presenter->impl->name, impl->name);
		display->next = slot;
		take_away(display);
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

static void bury(struct display *display)
{
	struct slot *next = display->next;
	const bool good = clock_now(display->params.clock) - display->made_ns > GOOD_LIFE;
	presenter_destroy(&display->now->presenter);
	display->now = display->next = NULL;
	display->taken_away = false;
	pthread_mutex_lock(&display->lock);
	display->let_go = false;
	pthread_mutex_unlock(&display->lock);
	if (next) {
		use(display, next);
		log_info(display->params.log, "%s presents now", next->presenter->impl->name);
		return;
	}
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
		take_away(display);
	} else if (let_go && display->taken_away) {
		bury(display);
	}
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
	clock_init_spinning(&display->clock, params->clock, (uint64_t)params->settings->spin_us * 1000);
	display->wake_fd = display->retry_fd = -1;
	pthread_mutex_init(&display->lock, NULL);
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
