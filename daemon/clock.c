/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/clock.h"

#include <errno.h>
#include <time.h>

#define SECOND UINT64_C(1000000000)

static struct timespec timespec_of(uint64_t time_ns)
{
	return (struct timespec){(time_t)(time_ns / SECOND), (long)(time_ns % SECOND)};
}

uint64_t clock_monotonic_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * SECOND + (uint64_t)now.tv_nsec;
}

void clock_monotonic_wait(uint64_t until_ns)
{
	const struct timespec until = timespec_of(until_ns);
	while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL) == EINTR)
		;
}

void clock_cond_init(pthread_cond_t *condition)
{
	pthread_condattr_t attributes;
	pthread_condattr_init(&attributes);
	pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
	pthread_cond_init(condition, &attributes);
	pthread_condattr_destroy(&attributes);
}

bool clock_cond_wait(pthread_cond_t *condition, pthread_mutex_t *lock, uint64_t until_ns)
{
	const struct timespec until = timespec_of(until_ns);
	return pthread_cond_timedwait(condition, lock, &until) != ETIMEDOUT;
}

static uint64_t real_now(struct clock *clock)
{
	(void)clock;
	return clock_monotonic_ns();
}

static void real_wait_until(struct clock *clock, uint64_t time_ns)
{
	(void)clock;
	clock_monotonic_wait(time_ns);
}

void clock_init_real(struct clock *clock)
{
	clock->now = real_now;
	clock->wait_until = real_wait_until;
}

static uint64_t virtual_now(struct clock *clock)
{
	return atomic_load(&((struct clock_virtual *)clock)->time_ns);
}

static void virtual_wait_until(struct clock *clock, uint64_t time_ns)
{
	struct clock_virtual *self = (struct clock_virtual *)clock;
	uint64_t now = atomic_load(&self->time_ns);
	while (now < time_ns && !atomic_compare_exchange_weak(&self->time_ns, &now, time_ns))
		;
}

void clock_init_virtual(struct clock_virtual *clock, uint64_t start_ns)
{
	clock->clock.now = virtual_now;
	clock->clock.wait_until = virtual_wait_until;
	atomic_init(&clock->time_ns, start_ns);
}

static uint64_t spinning_now(struct clock *clock)
{
	return clock_now(((struct clock_spinning *)clock)->inner);
}

static void spinning_wait_until(struct clock *clock, uint64_t time_ns)
{
	struct clock_spinning *self = (struct clock_spinning *)clock;
	const uint64_t spin_ns = atomic_load_explicit(&self->spin_ns, memory_order_relaxed);
	if (time_ns > spin_ns)
		clock_wait_until(self->inner, time_ns - spin_ns);
	while (clock_now(self->inner) < time_ns)
		;
}

void clock_init_spinning(struct clock_spinning *clock, struct clock *inner, uint64_t spin_ns)
{
	clock->clock.now = spinning_now;
	clock->clock.wait_until = spinning_wait_until;
	clock->inner = inner;
	atomic_init(&clock->spin_ns, spin_ns);
}

void clock_set_spin(struct clock_spinning *clock, uint64_t spin_ns)
{
	atomic_store_explicit(&clock->spin_ns, spin_ns, memory_order_relaxed);
}
