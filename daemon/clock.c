/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/clock.h"

#include <errno.h>
#include <time.h>

static uint64_t real_now(struct clock *clock)
{
	struct timespec now;
	(void)clock;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * UINT64_C(1000000000) + (uint64_t)now.tv_nsec;
}

static void real_wait_until(struct clock *clock, uint64_t time_ns)
{
	const struct timespec then = {(time_t)(time_ns / UINT64_C(1000000000)), (long)(time_ns % UINT64_C(1000000000))};
	(void)clock;
	while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &then, NULL) == EINTR)
		;
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
