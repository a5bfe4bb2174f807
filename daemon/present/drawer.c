/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/drawer.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <time.h>

#include "daemon/clock.h"
#include "daemon/present/blit.h"
#include "daemon/present/glx_sync.h"
#include "daemon/worker.h"

#define SECOND UINT64_C(1000000000)

struct drawer {
	struct window *window;
	struct clock clock; /* one of its own: that of who orders goes with him */
	struct worker *worker;
	pthread_mutex_t lock; /* for what is between here and there */
	pthread_cond_t wake, done;
	bool stop, started, under_way;
	void (*gone)(void *data); /* whose this is, once it is left */
	void *gone_data;
	int start_result;
	struct error start_error;
	bool black;
	struct presenter_image image;
	uint32_t width, height, swaps;
	uint64_t ordered_ns;
	struct drawer_swap swap; /* of the last order */

	/* the thread's own */
	struct blit blit;
	struct glx_sync sync;
};

static void free_drawer(struct drawer *drawer)
{
	pthread_cond_destroy(&drawer->wake);
	pthread_cond_destroy(&drawer->done);
	pthread_mutex_destroy(&drawer->lock);
	free(drawer);
}

/* ---- the thread ---- */

static int compare(const void *a, const void *b)
{
	const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

/* The first ones only fill the queue of the display server. */
static uint64_t median_interval(const uint64_t *times, uint32_t count)
{
	uint64_t intervals[DRAWER_SWAPS];
	uint32_t n = 0;
	for (uint32_t i = count / 3 + 1; i < count; i++)
		intervals[n++] = times[i] - times[i - 1];
	qsort(intervals, n, sizeof(intervals[0]), compare);
	return n >= 2 ? intervals[n / 2] : 0;
}

static struct drawer_swap carry_out(struct drawer *drawer, uint32_t swaps)
{
	struct drawer_swap swap = {.time_ns = 0};
	uint64_t times[DRAWER_SWAPS];
	for (uint32_t i = 0; i < swaps; i++) {
		blit_draw(&drawer->blit, drawer->black ? NULL : &drawer->image, drawer->width, drawer->height);
		if (i == 0)
			swap.drawing_ns = clock_now(&drawer->clock) - drawer->ordered_ns;
		window_swap(drawer->window);
		swap.source = PRESENTER_TIME_DISPLAY_SERVER;
		if (!glx_sync_wait(&drawer->sync, &swap.time_ns, &swap.sequence)) {
			blit_wait(&drawer->blit);
			swap.time_ns = clock_now(&drawer->clock);
			swap.source = PRESENTER_TIME_ESTIMATED;
		}
		times[i] = swap.time_ns;
	}
	swap.interval_ns = swaps >= 4 ? median_interval(times, swaps) : 0;
	return swap;
}

static int start(struct drawer *drawer, struct error *error)
{
	int result = window_make_current(drawer->window, error);
	if (result == 0) {
		result = blit_init(&drawer->blit, window_find_function, error);
		glx_sync_init(&drawer->sync, drawer->window, clock_now(&drawer->clock));
	}
	return result;
}

static void say_started(struct drawer *drawer, int result, const struct error *error)
{
	pthread_mutex_lock(&drawer->lock);
	drawer->started = true;
	drawer->start_result = result;
	drawer->start_error = *error;
	pthread_cond_signal(&drawer->done);
	pthread_mutex_unlock(&drawer->lock);
}

/* Should a library of the window end the thread when the display server goes away. */
static void on_exit_in_start(void *data)
{
	struct error error;
	error_set(&error, -EIO, "glfw: the display server went away while the window was made");
	say_started(data, -EIO, &error);
}

static void carry_out_orders(struct drawer *drawer)
{
	pthread_mutex_lock(&drawer->lock);
	while (!drawer->stop) {
		if (!drawer->under_way) {
			pthread_cond_wait(&drawer->wake, &drawer->lock);
			continue;
		}
		pthread_mutex_unlock(&drawer->lock);
		const struct drawer_swap swap = carry_out(drawer, drawer->swaps);
		pthread_mutex_lock(&drawer->lock);
		drawer->swap = swap;
		drawer->under_way = false;
		pthread_cond_signal(&drawer->done);
	}
	pthread_mutex_unlock(&drawer->lock);
}

static void run(void *data)
{
	struct drawer *drawer = data;
	struct error error = {""};
	int result;
	pthread_setname_np(pthread_self(), "pursuit-swap");
	prctl(PR_SET_TIMERSLACK, 1ul, 0, 0, 0);
	pthread_cleanup_push(on_exit_in_start, drawer);
	result = start(drawer, &error);
	pthread_cleanup_pop(0);
	say_started(drawer, result, &error);
	if (result == 0)
		carry_out_orders(drawer);
	blit_finish(&drawer->blit);
	window_let_go(drawer->window);
}

/* ---- whoever orders ---- */

struct drawer *drawer_create(struct window *window, struct error *error)
{
	struct drawer *drawer = calloc(1, sizeof(*drawer));
	if (!drawer) {
		error_set(error, -ENOMEM, "glfw: out of memory");
		return NULL;
	}
	drawer->window = window;
	clock_init_real(&drawer->clock);
	pthread_mutex_init(&drawer->lock, NULL);
	clock_cond_init(&drawer->wake);
	clock_cond_init(&drawer->done);
	const int result = worker_create(&drawer->worker, run, drawer);
	if (result < 0) {
		error_set(error, result, "glfw: cannot start a thread: %s", strerror(-result));
		free_drawer(drawer);
		return NULL;
	}
	return drawer;
}

int drawer_wait_for_start(struct drawer *drawer, struct error *error)
{
	const uint64_t until_ns = clock_monotonic_ns() + DRAWER_START_NS;
	pthread_mutex_lock(&drawer->lock);
	while (!drawer->started && clock_cond_wait(&drawer->done, &drawer->lock, until_ns))
		;
	int result = drawer->start_result;
	if (!drawer->started)
		result = error_set(error, -ETIMEDOUT, "glfw: the display server does not answer");
	else if (result < 0)
		*error = drawer->start_error;
	pthread_mutex_unlock(&drawer->lock);
	return result;
}

static void on_gone(void *data)
{
	struct drawer *drawer = data;
	drawer->gone(drawer->gone_data);
	free_drawer(drawer);
}

bool drawer_destroy(struct drawer **drawer, void (*gone)(void *data), void *data)
{
	struct drawer *self = *drawer;
	*drawer = NULL;
	if (!self)
		return true;
	pthread_mutex_lock(&self->lock);
	self->stop = true;
	self->gone = gone;
	self->gone_data = data;
	pthread_cond_signal(&self->wake);
	pthread_mutex_unlock(&self->lock);
	if (!worker_destroy(&self->worker, SECOND, on_gone))
		return false;
	free_drawer(self);
	return true;
}

void drawer_order(struct drawer *drawer, const struct presenter_image *image, uint32_t width, uint32_t height,
				  uint32_t swaps)
{
	pthread_mutex_lock(&drawer->lock);
	drawer->black = !image;
	if (image)
		drawer->image = *image;
	drawer->width = width ? width : 1;
	drawer->height = height ? height : 1;
	drawer->swaps = swaps;
	drawer->ordered_ns = clock_now(&drawer->clock);
	drawer->under_way = true;
	pthread_cond_signal(&drawer->wake);
	pthread_mutex_unlock(&drawer->lock);
}

bool drawer_wait(struct drawer *drawer, uint64_t until_ns, struct drawer_swap *swap)
{
	pthread_mutex_lock(&drawer->lock);
	while (drawer->under_way && clock_cond_wait(&drawer->done, &drawer->lock, until_ns))
		;
	const bool done = !drawer->under_way;
	*swap = drawer->swap;
	pthread_mutex_unlock(&drawer->lock);
	return done;
}
