/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/cpu/pool.h"

#include <assert.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>

struct worker {
	struct pool *pool;
	uint32_t number;
	pthread_t thread;
};

struct pool {
	pthread_mutex_t lock;
	pthread_cond_t wake, done;
	struct worker workers[POOL_MAX_THREADS - 1];
	uint32_t worker_count;
	/* The task; under the lock but for `next`. */
	pool_function function;
	void *context;
	uint32_t count;
	atomic_uint next;
	uint64_t task; /* counts tasks */
	bool open;     /* workers may still join */
	uint32_t busy; /* workers that have joined */
	bool stop;
};

static uint32_t count_cpus(void)
{
	cpu_set_t set;
	CPU_ZERO(&set);
	if (sched_getaffinity(0, sizeof(set), &set) < 0)
		return 1;
	int count = CPU_COUNT(&set);
	return count < 1 ? 1 : count > (int)POOL_MAX_THREADS ? POOL_MAX_THREADS : (uint32_t)count;
}

static void take_items(struct pool *pool, pool_function function, void *context, uint32_t count, uint32_t thread)
{
	for (;;) {
		uint32_t item = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);
		if (item >= count)
			return;
		function(context, item, thread);
	}
}

static void *work(void *argument)
{
	struct worker *worker = argument;
	struct pool *pool = worker->pool;
	uint64_t seen = 0;
	pthread_mutex_lock(&pool->lock);
	while (!pool->stop) {
		if (!pool->open || pool->task == seen) {
			pthread_cond_wait(&pool->wake, &pool->lock);
			continue;
		}
		seen = pool->task;
		pool->busy++;
		pool_function function = pool->function;
		void *context = pool->context;
		uint32_t count = pool->count;
		pthread_mutex_unlock(&pool->lock);
		take_items(pool, function, context, count, worker->number);
		pthread_mutex_lock(&pool->lock);
		if (--pool->busy == 0)
			pthread_cond_signal(&pool->done);
	}
	pthread_mutex_unlock(&pool->lock);
	return NULL;
}

static void start_workers(struct pool *pool, uint32_t wanted)
{
	sigset_t all, before;
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	for (uint32_t i = 0; i < wanted; i++) {
		pool->workers[i] = (struct worker){.pool = pool, .number = i + 1};
		if (pthread_create(&pool->workers[i].thread, NULL, work, &pool->workers[i]) != 0)
			break;
		pool->worker_count++;
	}
	pthread_sigmask(SIG_SETMASK, &before, NULL);
}

struct pool *pool_create(uint32_t threads)
{
	struct pool *pool = calloc(1, sizeof(*pool));
	if (!pool)
		return NULL;
	pthread_mutex_init(&pool->lock, NULL);
	pthread_cond_init(&pool->wake, NULL);
	pthread_cond_init(&pool->done, NULL);
	uint32_t wanted = threads ? threads : count_cpus();
	start_workers(pool, (wanted < POOL_MAX_THREADS ? wanted : POOL_MAX_THREADS) - 1);
	return pool;
}

void pool_destroy(struct pool **pool)
{
	struct pool *gone = *pool;
	if (!gone)
		return;
	pthread_mutex_lock(&gone->lock);
	gone->stop = true;
	pthread_cond_broadcast(&gone->wake);
	pthread_mutex_unlock(&gone->lock);
	for (uint32_t i = 0; i < gone->worker_count; i++)
		pthread_join(gone->workers[i].thread, NULL);
	pthread_cond_destroy(&gone->wake);
	pthread_cond_destroy(&gone->done);
	pthread_mutex_destroy(&gone->lock);
	free(gone);
	*pool = NULL;
}

uint32_t pool_threads(const struct pool *pool)
{
	return pool->worker_count + 1;
}

void pool_start(struct pool *pool, pool_function function, void *context, uint32_t count)
{
	assert(!pool->open);
	pthread_mutex_lock(&pool->lock);
	pool->function = function;
	pool->context = context;
	pool->count = count;
	atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
	pool->task++;
	pool->open = true;
	if (count > 1)
		pthread_cond_broadcast(&pool->wake);
	pthread_mutex_unlock(&pool->lock);
}

void pool_finish(struct pool *pool)
{
	if (!pool->open)
		return;
	take_items(pool, pool->function, pool->context, pool->count, 0);
	pthread_mutex_lock(&pool->lock);
	/* Who still sleeps is not waited for. */
	pool->open = false;
	while (pool->busy > 0)
		pthread_cond_wait(&pool->done, &pool->lock);
	pthread_mutex_unlock(&pool->lock);
}

void pool_run(struct pool *pool, pool_function function, void *context, uint32_t count)
{
	if (!count)
		return;
	pool_start(pool, function, context, count);
	pool_finish(pool);
}
