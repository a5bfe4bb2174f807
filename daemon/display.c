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

struct display {
	struct display_params params;
	struct presenter *presenter;
	struct loop_source *presenter_source, *wake_source, *retry_source;
	int wake_fd, retry_fd;
	uint64_t made_ns, delay_ns;
	bool taken_away; /* the user was told, and has not answered */

	pthread_mutex_t lock; /* for what other threads say */
	bool lost, let_go;
	char sentence[256];
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
	struct display *display = data;
	pthread_mutex_lock(&display->lock);
	if (!display->lost)
		snprintf(display->sentence, sizeof(display->sentence), "%s", sentence);
	display->lost = true;
	pthread_mutex_unlock(&display->lock);
	wake(display);
}

/* On main: what is made next is another one. */
static void on_failed(void *data)
{
	struct display *display = data;
	pthread_mutex_lock(&display->lock);
	display->lost = false;
	pthread_mutex_unlock(&display->lock);
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
	struct display *display = data;
	display->params.flip(display->params.data, flip);
}

static void on_key(void *data, const struct presenter_key *key)
{
	struct display *display = data;
	display->params.key(display->params.data, key);
}

static void on_presenter_event(void *data, uint32_t events)
{
	struct display *display = data;
	(void)events;
	display->presenter->impl->process_events(display->presenter);
}

/* ---- making one ---- */

/* An engine that is to run elsewhere cannot use it. */
static bool may_share_gl(const struct settings *settings)
{
	return !settings->gles && (strcmp(settings->context, "auto") == 0 || strcmp(settings->context, "egl") == 0);
}

static struct presenter *make(struct display *display, struct error *error)
{
	const struct settings *settings = display->params.settings;
	const struct presenter_params params = {
		.clock = display->params.clock,
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
		.data = display,
		.vsync = display->params.vsync,
	};
	return presenter_create(settings->present, &params, error);
}

static int use_first_that_works(struct display *display, struct error *error)
{
	struct presenter *presenter = make(display, error);
	if (!presenter)
		return -ENODEV;
	display->presenter = presenter;
	display->made_ns = clock_now(display->params.clock);
	if (presenter->impl->get_event_fd)
		display->presenter_source = loop_add(display->params.loop, presenter->impl->get_event_fd(presenter), EPOLLIN,
											 on_presenter_event, display);
	display->params.change(display->params.data, presenter);
	return 0;
}

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

static void on_retry(void *data, uint32_t events)
{
	struct display *display = data;
	struct error error = {""};
	uint64_t count;
	(void)events;
	if (read(display->retry_fd, &count, sizeof(count)) < 0)
		return;
	if (use_first_that_works(display, &error) == 0) {
		log_info(display->params.log, "%s presents now", display->presenter->impl->name);
		return;
	}
	longer_delay(display);
	log_warning(display->params.log, "no presenter works; the next attempt is in %u ms",
				(unsigned)(display->delay_ns / 1000000));
	try_later(display);
}

/* ---- losing one ---- */

static void take_away(struct display *display, const char *sentence)
{
	display->taken_away = true;
	log_warning(display->params.log, "%s is lost: %s", display->presenter->impl->name, sentence);
	loop_remove(&display->presenter_source);
	display->params.change(display->params.data, NULL);
}

static void bury(struct display *display)
{
	const bool good = clock_now(display->params.clock) - display->made_ns > GOOD_LIFE;
	presenter_destroy(&display->presenter);
	display->taken_away = false;
	pthread_mutex_lock(&display->lock);
	display->lost = display->let_go = false;
	pthread_mutex_unlock(&display->lock);
	if (good)
		display->delay_ns = 0;
	else
		longer_delay(display);
	try_later(display);
}

static void on_wake(void *data, uint32_t events)
{
	struct display *display = data;
	char sentence[sizeof(display->sentence)];
	uint64_t count;
	(void)events;
	if (read(display->wake_fd, &count, sizeof(count)) < 0)
		return;
	pthread_mutex_lock(&display->lock);
	const bool lost = display->lost, let_go = display->let_go;
	memcpy(sentence, display->sentence, sizeof(sentence));
	pthread_mutex_unlock(&display->lock);
	if (lost && !display->taken_away && display->presenter)
		take_away(display, sentence);
	else if (let_go && display->taken_away)
		bury(display);
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
	presenter_destroy(&self->presenter);
	if (self->wake_fd >= 0)
		close(self->wake_fd);
	if (self->retry_fd >= 0)
		close(self->retry_fd);
	pthread_mutex_destroy(&self->lock);
	free(self);
}

void display_toggle_fullscreen(struct display *display)
{
	if (display->presenter && !display->taken_away && display->presenter->impl->toggle_fullscreen)
		display->presenter->impl->toggle_fullscreen(display->presenter);
}
