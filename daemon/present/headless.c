/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The headless presenter: no display, but the timing of one. A thread sleeps
 * until each vblank of an absolute grid (or of the external vsync, if there is
 * one), makes the queued picture the one on display, and notes when it did so. A picture counts for a vblank only if it
 * was queued before the vblank's time, as with hardware.
 */
#include <errno.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>

#include "daemon/present/pictures.h"

struct headless {
	struct pictures pictures;
	pthread_t thread;
};

static void *run(void *data)
{
	struct headless *self = data;
	struct pictures *pictures = &self->pictures;
	const struct sched_param priority = {.sched_priority = 1};

	pthread_setname_np(pthread_self(), "pursuit-flip");
	/* It runs for microseconds a vblank, and what it measures is the display. Not permitted to most: no matter. */
	if (pthread_setschedparam(pthread_self(), SCHED_RR, &priority) != 0)
		log_debug(pictures->params.log, "headless: no real-time priority for the flips");
	prctl(PR_SET_TIMERSLACK, 1ul, 0, 0, 0);
	pthread_mutex_lock(&pictures->lock);
	while (!pictures->stop) {
		const bool by_vsync = pictures_follow_vsync(pictures, clock_now(pictures->params.clock));
		if (!pictures->running) {
			pthread_cond_wait(&pictures->wake, &pictures->lock);
			continue;
		}
		const uint64_t vblank = pictures->next_vblank, target_ns = grid_time(&pictures->grid, vblank);
		pthread_mutex_unlock(&pictures->lock);
		clock_wait_until(pictures->params.clock, target_ns);
		pthread_mutex_lock(&pictures->lock);
		if (pictures->stop || !pictures->running || pictures->next_vblank != vblank)
			continue;
		struct presenter_flip flip = pictures_show_next(pictures, clock_now(pictures->params.clock));
		flip.late |= flip.flip_ns >= grid_time(&pictures->grid, flip.vblank + 1);
		flip.time_source = by_vsync ? PRESENTER_TIME_EXTERNAL : PRESENTER_TIME_TIMER;
		/* A display shows it at a vblank, whenever the timer fired. */
		if (by_vsync && !flip.late)
			flip.flip_ns = flip.target_ns;
		pthread_mutex_unlock(&pictures->lock);
		pictures->params.flip(pictures->params.data, &flip);
		pthread_mutex_lock(&pictures->lock);
	}
	pthread_mutex_unlock(&pictures->lock);
	return NULL;
}

static struct presenter *headless_create(const struct presenter_params *params, struct error *error)
{
	struct headless *self = calloc(1, sizeof(*self));
	if (!self) {
		error_set(error, -ENOMEM, "headless: out of memory");
		return NULL;
	}
	pictures_init(&self->pictures, &presenter_headless, params);
	const int result = pthread_create(&self->thread, NULL, run, self);
	if (result == 0)
		return &self->pictures.presenter;
	error_set(error, -result, "headless: cannot start a thread: %s", strerror(result));
	pictures_finish(&self->pictures);
	free(self);
	return NULL;
}

static void headless_destroy(struct presenter *presenter)
{
	struct headless *self = (struct headless *)presenter;
	pthread_mutex_lock(&self->pictures.lock);
	self->pictures.stop = true;
	pthread_cond_signal(&self->pictures.wake);
	pthread_mutex_unlock(&self->pictures.lock);
	pthread_join(self->thread, NULL);
	pictures_finish(&self->pictures);
	free(self);
}

const struct presenter_impl presenter_headless = {
	.name = "headless",
	.description = "no display: pictures in memory, shown on an exact grid",
	.create = headless_create,
	.destroy = headless_destroy,
	.get_grid = pictures_get_grid,
	.get_lead = pictures_get_lead,
	.acquire = pictures_acquire,
	.release = pictures_release,
	.present = pictures_present,
	.set_standby = pictures_set_standby,
	.clear_standby = pictures_clear_standby,
	.pause = pictures_pause,
};
