/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pool.h"

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

struct task {
	pool_function function;
	void *context;
	uint32_t count;
	atomic_uint next;
	uint32_t busy; /* workers that have joined */
};

struct pool {
	pthread_mutex_t lock;
	pthread_cond_t wake, done;
	struct worker workers[POOL_MAX_THREADS - 1];
	uint32_t worker_count;
	/* Under the lock but for `next`. */
	struct task tasks[POOL_MAX_TASKS];
	uint32_t depth; /* tasks that workers may join; only the caller changes it */
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

static void take_items(struct task *task, uint32_t thread)
{
	for (;;) {
		uint32_t item = atomic_fetch_add_explicit(&task->next, 1, memory_order_relaxed);
		if (item >= task->count)
			return;
		task->function(task->context, item, thread);
	}
}

/* The task started last that has items left. */
static struct task *find_task(struct pool *pool)
{
	for (uint32_t i = pool->depth; i-- > 0;)
		if (atomic_load_explicit(&pool->tasks[i].next, memory_order_relaxed) < pool->tasks[i].count)
			return &pool->tasks[i];
	return NULL;
}

static void *work(void *argument)
{
	struct worker *worker = argument;
	struct pool *pool = worker->pool;
	pthread_mutex_lock(&pool->lock);
	while (!pool->stop) {
		struct task *task = find_task(pool);
		if (!task) {
			pthread_cond_wait(&pool->wake, &pool->lock);
			continue;
		}
		task->busy++;
		pthread_mutex_unlock(&pool->lock);
		take_items(task, worker->number);
		pthread_mutex_lock(&pool->lock);
		if (--task->busy == 0)
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
	return pool ? pool->worker_count + 1 : 1;
}

void pool_start(struct pool *pool, pool_function function, void *context, uint32_t count)
{
	assert(pool->depth < POOL_MAX_TASKS);
	pthread_mutex_lock(&pool->lock);
	struct task *task = &pool->tasks[pool->depth++];
	task->function = function;
	task->context = context;
	task->count = count;
	atomic_store_explicit(&task->next, 0, memory_order_relaxed);
	if (count > 1)
		pthread_cond_broadcast(&pool->wake);
	pthread_mutex_unlock(&pool->lock);
}

void pool_finish(struct pool *pool)
{
	if (!pool->depth)
		return;
	struct task *task = &pool->tasks[pool->depth - 1];
	take_items(task, 0);
	pthread_mutex_lock(&pool->lock);
	/* Who still sleeps is not waited for. */
	pool->depth--;
	while (task->busy > 0)
		pthread_cond_wait(&pool->done, &pool->lock);
	pthread_mutex_unlock(&pool->lock);
}

void pool_run(struct pool *pool, pool_function function, void *context, uint32_t count)
{
	if (pool && count > 1) {
		pool_start(pool, function, context, count);
		pool_finish(pool);
		return;
	}
	for (uint32_t i = 0; i < count; i++)
		function(context, i, 0);
}
