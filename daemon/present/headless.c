/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The headless presenter: no display, but the timing of one. Pictures lie in
 * CPU memory; a thread sleeps until each vblank of an absolute grid, makes the
 * queued picture the one on display, and notes when it did so. A picture counts
 * for a vblank only if it was queued before the vblank's time, as with hardware.
 */
#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>

#include "daemon/present/flips.h"
#include "daemon/present/presenter.h"

/* A thread that slept so many vblanks too long skips them rather than showing them in a burst. */
#define SKIP_AFTER 8u

struct headless {
	struct presenter presenter;
	struct presenter_params params;
	struct grid grid;
	pthread_t thread;
	pthread_mutex_t lock; /* for all below */
	pthread_cond_t wake;
	struct flips flips;
	uint64_t next_vblank; /* the first one not handled */
	bool running;         /* vblanks are handled */
	bool stop;
	struct headless_memory {
		uint8_t *data;
		size_t size;
	} memory[FLIPS_IMAGES]; /* of an acquired picture: the render thread's */
};

/* Handles vblank next_vblank; with the lock. */
static struct presenter_flip show_next(struct headless *self, uint64_t now_ns)
{
	struct presenter_flip flip = {.flip_ns = now_ns, .time_source = PRESENTER_TIME_TIMER};
	const uint64_t newest = grid_at_or_after(&self->grid, now_ns + 1) - 1;

	if (newest > self->next_vblank + SKIP_AFTER) {
		flip.skipped = (uint32_t)(newest - self->next_vblank);
		self->next_vblank = newest;
	}
	flip.vblank = self->next_vblank++;
	flip.target_ns = grid_time(&self->grid, flip.vblank);
	flip.late = now_ns >= grid_time(&self->grid, flip.vblank + 1);
	flip.shown = flips_show(&self->flips, flip.vblank);
	if (self->flips.has_front) {
		flip.serial = self->flips.front.serial;
		flip.group = self->flips.front.group;
	}
	return flip;
}

static void *run(void *data)
{
	struct headless *self = data;
	const struct sched_param priority = {.sched_priority = 1};

	pthread_setname_np(pthread_self(), "pursuit-flip");
	/* It runs for microseconds a vblank, and what it measures is the display. Not permitted to most: no matter. */
	if (pthread_setschedparam(pthread_self(), SCHED_RR, &priority) != 0)
		log_debug(self->params.log, "headless: no real-time priority for the flips");
	prctl(PR_SET_TIMERSLACK, 1ul, 0, 0, 0);
	pthread_mutex_lock(&self->lock);
	while (!self->stop) {
		if (!self->running) {
			pthread_cond_wait(&self->wake, &self->lock);
			continue;
		}
		const uint64_t target_ns = grid_time(&self->grid, self->next_vblank);
		pthread_mutex_unlock(&self->lock);
		clock_wait_until(self->params.clock, target_ns);
		pthread_mutex_lock(&self->lock);
		if (self->stop || !self->running || grid_time(&self->grid, self->next_vblank) != target_ns)
			continue;
		const struct presenter_flip flip = show_next(self, clock_now(self->params.clock));
		pthread_mutex_unlock(&self->lock);
		self->params.flip(self->params.data, &flip);
		pthread_mutex_lock(&self->lock);
	}
	pthread_mutex_unlock(&self->lock);
	return NULL;
}

static struct headless *self_of(struct presenter *presenter)
{
	return (struct headless *)presenter;
}

static struct presenter *headless_create(const struct presenter_params *params, struct error *error)
{
	struct headless *self = calloc(1, sizeof(*self));
	if (!self) {
		error_set(error, -ENOMEM, "headless: out of memory");
		return NULL;
	}
	self->presenter.impl = &presenter_headless;
	self->params = *params;
	self->grid = (struct grid){.numerator = params->refresh_numerator,
							   .denominator = params->refresh_denominator,
							   .epoch_ns = clock_now(params->clock)};
	pthread_mutex_init(&self->lock, NULL);
	pthread_cond_init(&self->wake, NULL);
	const int result = pthread_create(&self->thread, NULL, run, self);
	if (result != 0) {
		error_set(error, -result, "headless: cannot start a thread: %s", strerror(result));
		pthread_cond_destroy(&self->wake);
		pthread_mutex_destroy(&self->lock);
		free(self);
		return NULL;
	}
	return &self->presenter;
}

static void headless_destroy(struct presenter *presenter)
{
	struct headless *self = self_of(presenter);
	pthread_mutex_lock(&self->lock);
	self->stop = true;
	pthread_cond_signal(&self->wake);
	pthread_mutex_unlock(&self->lock);
	pthread_join(self->thread, NULL);
	for (uint32_t i = 0; i < FLIPS_IMAGES; i++)
		free(self->memory[i].data);
	pthread_cond_destroy(&self->wake);
	pthread_mutex_destroy(&self->lock);
	free(self);
}

static struct grid headless_get_grid(struct presenter *presenter)
{
	return self_of(presenter)->grid;
}

static int headless_acquire(struct presenter *presenter, uint32_t width, uint32_t height, struct presenter_image *image)
{
	struct headless *self = self_of(presenter);
	const size_t stride = ((size_t)width * 4 + 63) / 64 * 64, size = stride * height;

	pthread_mutex_lock(&self->lock);
	const int index = flips_acquire(&self->flips);
	pthread_mutex_unlock(&self->lock);
	if (index < 0)
		return -EBUSY;
	struct headless_memory *memory = &self->memory[index];
	if (memory->size != size) {
		free(memory->data);
		memory->data = aligned_alloc(64, size);
		memory->size = memory->data ? size : 0;
	}
	*image = (struct presenter_image){memory->data, stride, width, height, (uint32_t)index};
	if (memory->data)
		return 0;
	presenter->impl->release(presenter, image);
	return -ENOMEM;
}

static void headless_release(struct presenter *presenter, const struct presenter_image *image)
{
	struct headless *self = self_of(presenter);
	pthread_mutex_lock(&self->lock);
	flips_release(&self->flips, image->index);
	pthread_mutex_unlock(&self->lock);
}

static int headless_present(struct presenter *presenter, const struct presenter_image *image, uint64_t vblank,
							uint64_t group, uint64_t serial)
{
	struct headless *self = self_of(presenter);
	int result = -ETIME;

	pthread_mutex_lock(&self->lock);
	const bool in_time = clock_now(self->params.clock) < grid_time(&self->grid, vblank);
	if (in_time && (!self->running || vblank >= self->next_vblank))
		result = flips_present(&self->flips, image->index, vblank, group, serial) ? 0 : -EBUSY;
	if (result == 0 && !self->running) {
		self->running = true;
		self->next_vblank = vblank;
		pthread_cond_signal(&self->wake);
	}
	pthread_mutex_unlock(&self->lock);
	return result;
}

static void headless_set_standby(struct presenter *presenter, const struct presenter_image *image, uint64_t group,
								 uint64_t serial)
{
	struct headless *self = self_of(presenter);
	pthread_mutex_lock(&self->lock);
	flips_set_standby(&self->flips, image->index, group, serial);
	pthread_mutex_unlock(&self->lock);
}

static void headless_clear_standby(struct presenter *presenter)
{
	struct headless *self = self_of(presenter);
	pthread_mutex_lock(&self->lock);
	flips_clear_standby(&self->flips);
	pthread_mutex_unlock(&self->lock);
}

static void headless_pause(struct presenter *presenter)
{
	struct headless *self = self_of(presenter);
	pthread_mutex_lock(&self->lock);
	self->running = false;
	pthread_mutex_unlock(&self->lock);
}

const struct presenter_impl presenter_headless = {
	.name = "headless",
	.description = "no display: pictures in memory, shown on an exact grid",
	.create = headless_create,
	.destroy = headless_destroy,
	.get_grid = headless_get_grid,
	.acquire = headless_acquire,
	.release = headless_release,
	.present = headless_present,
	.set_standby = headless_set_standby,
	.clear_standby = headless_clear_standby,
	.pause = headless_pause,
};
