/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The clock: now, and wait until. The real one is CLOCK_MONOTONIC; the virtual
 * one stands still until somebody waits, for tests and replay.
 *
 * Who is told a time never reads a clock of its own (pacer, statistics).
 */
#ifndef PURSUIT_CLOCK_H
#define PURSUIT_CLOCK_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct clock {
	uint64_t (*now)(struct clock *clock); /* ns; any thread */
	/* Returns at time_ns or later; at once if that is over. Any thread. */
	void (*wait_until)(struct clock *clock, uint64_t time_ns);
};

static inline uint64_t clock_now(struct clock *clock)
{
	return clock->now(clock);
}

static inline void clock_wait_until(struct clock *clock, uint64_t time_ns)
{
	clock->wait_until(clock, time_ns);
}

/* CLOCK_MONOTONIC, ns: for who is at no clock of its own. Any thread. */
uint64_t clock_monotonic_ns(void);
/* Sleeps until then; not at all if it is over. Any thread. */
void clock_monotonic_wait(uint64_t until_ns);

/* A condition for clock_cond_wait(). */
void clock_cond_init(pthread_cond_t *condition);
/*
 * With the lock: sleeps until the condition is signalled, or for no reason, until that time of CLOCK_MONOTONIC at most.
 * False: it is over.
 */
bool clock_cond_wait(pthread_cond_t *condition, pthread_mutex_t *lock, uint64_t until_ns);

/* CLOCK_MONOTONIC, absolute waits. Needs no finish. */
void clock_init_real(struct clock *clock);

/* Waiting moves it there. Meant for one thread that waits. */
struct clock_virtual {
	struct clock clock;
	_Atomic uint64_t time_ns;
};

void clock_init_virtual(struct clock_virtual *clock, uint64_t start_ns);

/*
 * Another one, which goes on by itself unless spin_ns is 0, in whose waits the last spin_ns are spent looking at it: a
 * thread that sleeps is woken some time too late. That costs a processor for so long each time.
 */
struct clock_spinning {
	struct clock clock;
	struct clock *inner; /* lives as long */
	_Atomic uint64_t spin_ns;
};

void clock_init_spinning(struct clock_spinning *clock, struct clock *inner, uint64_t spin_ns);
/* Any thread: from the next wait on. */
void clock_set_spin(struct clock_spinning *clock, uint64_t spin_ns);

#endif
