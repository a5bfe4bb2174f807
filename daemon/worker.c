/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/worker.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>

#include "daemon/clock.h"

struct worker {
	void (*run)(void *data);
	void *data;
	pthread_t thread;
	pthread_mutex_t lock; /* for all below */
	pthread_cond_t end;
	bool ended, left;
	void (*gone)(void *data);
};

static void free_worker(struct worker *worker)
{
	pthread_cond_destroy(&worker->end);
	pthread_mutex_destroy(&worker->lock);
	free(worker);
}

static void on_end(void *data)
{
	struct worker *worker = data;
	pthread_mutex_lock(&worker->lock);
	const bool left = worker->left;
	worker->ended = true;
	pthread_cond_signal(&worker->end);
	pthread_mutex_unlock(&worker->lock);
	if (!left)
		return; /* not ours from here on */
	if (worker->gone)
		worker->gone(worker->data);
	free_worker(worker);
}

static void *run(void *data)
{
	struct worker *worker = data;
	pthread_cleanup_push(on_end, worker);
	worker->run(worker->data);
	pthread_cleanup_pop(1);
	return NULL;
}

int worker_create(struct worker **worker, void (*function)(void *data), void *data)
{
	struct worker *self = calloc(1, sizeof(*self));
	*worker = NULL;
	if (!self)
		return -ENOMEM;
	self->run = function;
	self->data = data;
	pthread_mutex_init(&self->lock, NULL);
	clock_cond_init(&self->end);
	const int result = pthread_create(&self->thread, NULL, run, self);
	if (result != 0)
		free_worker(self);
	else
		*worker = self;
	return -result;
}

/* With the lock. pthread_clockjoin_np() would do, but ThreadSanitizer of GCC 12 does not see it. */
static bool wait_for_end(struct worker *worker, uint64_t patience_ns)
{
	const uint64_t until_ns = clock_monotonic_ns() + patience_ns;
	while (!worker->ended && clock_cond_wait(&worker->end, &worker->lock, until_ns))
		;
	return worker->ended;
}

bool worker_wait(struct worker *worker, uint64_t patience_ns)
{
	pthread_mutex_lock(&worker->lock);
	const bool ended = wait_for_end(worker, patience_ns);
	pthread_mutex_unlock(&worker->lock);
	return ended;
}

bool worker_destroy(struct worker **worker, uint64_t patience_ns, void (*gone)(void *data))
{
	struct worker *self = *worker;
	*worker = NULL;
	if (!self)
		return true;
	pthread_mutex_lock(&self->lock);
	const bool ended = wait_for_end(self, patience_ns);
	self->gone = gone;
	self->left = !ended;
	if (!ended)
		pthread_detach(self->thread);
	pthread_mutex_unlock(&self->lock);
	if (!ended)
		return false;
	pthread_join(self->thread, NULL);
	free_worker(self);
	return true;
}
