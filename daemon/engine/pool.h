/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A few threads that share out the items of a task; the caller works too. Which
 * thread does which item is left to chance, so items must not depend on each
 * other. Functions that take a pool accept NULL: the caller works alone.
 */
#ifndef PURSUIT_ENGINE_POOL_H
#define PURSUIT_ENGINE_POOL_H

#include <stdint.h>

#define POOL_MAX_THREADS 8u
#define POOL_MAX_TASKS 2u

struct pool;

/* `thread` is below pool_threads() and no two items run on one thread at once: for scratch memory. */
typedef void (*pool_function)(void *context, uint32_t item, uint32_t thread);

/*
 * `threads`: with the caller, 1 to POOL_MAX_THREADS; 0: one for each CPU that the process may run on. Fewer if the
 * system gives no more. The threads inherit policy, priority and slice of the caller and take no signals. NULL if
 * memory is out.
 */
struct pool *pool_create(uint32_t threads);
void pool_destroy(struct pool **pool);
uint32_t pool_threads(const struct pool *pool);

/* Does items 0 to count - 1 and returns when all are done. */
void pool_run(struct pool *pool, pool_function function, void *context, uint32_t count);

/*
 * The same in two steps, between which the caller does something else, other tasks among it: those run while this one
 * goes on. At most POOL_MAX_TASKS at a time, the one started last is finished first.
 */
void pool_start(struct pool *pool, pool_function function, void *context, uint32_t count);
/* Helps with the task started last and waits for it. Does nothing if nothing was started. */
void pool_finish(struct pool *pool);

#endif
