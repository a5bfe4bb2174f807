/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A thread that may hang in what is not ours: a display server, a disk. Whoever
 * ends it waits only so long; then it is left to itself, and says so when it
 * comes back, if ever.
 */
#ifndef PURSUIT_WORKER_H
#define PURSUIT_WORKER_H

#include <stdbool.h>
#include <stdint.h>

struct worker;

/* Runs run(data) on a thread of its own, which may also end by pthread_exit(). 0 or a negative errno. */
int worker_create(struct worker **worker, void (*run)(void *data), void *data);

/* Waits for the end of run(), so long by CLOCK_MONOTONIC at most. Has it ended? */
bool worker_wait(struct worker *worker, uint64_t patience_ns);

/*
 * Waits likewise and lets the thread go. True: it has ended, and all that it did is seen here.
 * False: it goes on, with `data` and all that it uses; gone(data) is called on its thread when it has ended (NULL: what
 * it uses stays for ever). Clears *worker either way; NULL accepted.
 */
bool worker_destroy(struct worker **worker, uint64_t patience_ns, void (*gone)(void *data));

#endif
