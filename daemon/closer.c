/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/closer.h"

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>

struct work {
	struct work *next;
	void (*close)(void *thing);
	void *thing;
};

struct closer {
	pthread_mutex_t lock;
	pthread_cond_t wake;
	pthread_t thread;
	bool running, stop;
	struct work *first, **end;
};

static void *run(void *data)
{
	struct closer *closer = data;
	pthread_setname_np(pthread_self(), "pursuit-closer");
	pthread_mutex_lock(&closer->lock);
	while (!closer->stop || closer->first) {
		struct work *work = closer->first;
		if (!work) {
			pthread_cond_wait(&closer->wake, &closer->lock);
			continue;
		}
		closer->first = work->next;
		if (!closer->first)
			closer->end = &closer->first;
		pthread_mutex_unlock(&closer->lock);
		work->close(work->thing);
		free(work);
		pthread_mutex_lock(&closer->lock);
	}
	pthread_mutex_unlock(&closer->lock);
	return NULL;
}

struct closer *closer_create(struct error *error)
{
	struct closer *closer = calloc(1, sizeof(*closer));
	if (!closer) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	pthread_mutex_init(&closer->lock, NULL);
	pthread_cond_init(&closer->wake, NULL);
	closer->end = &closer->first;
	return closer;
}

void closer_destroy(struct closer **closer)
{
	struct closer *self = *closer;
	*closer = NULL;
	if (!self)
		return;
	pthread_mutex_lock(&self->lock);
	self->stop = true;
	pthread_cond_signal(&self->wake);
	pthread_mutex_unlock(&self->lock);
	if (self->running)
		pthread_join(self->thread, NULL);
	pthread_cond_destroy(&self->wake);
	pthread_mutex_destroy(&self->lock);
	free(self);
}

void closer_add(struct closer *closer, void (*close)(void *thing), void *thing)
{
	struct work *work = malloc(sizeof(*work));
	if (work)
		*work = (struct work){NULL, close, thing};
	pthread_mutex_lock(&closer->lock);
	if (!closer->running)
		closer->running = pthread_create(&closer->thread, NULL, run, closer) == 0;
	const bool taken = work && closer->running;
	if (taken) {
		*closer->end = work;
		closer->end = &work->next;
		pthread_cond_signal(&closer->wake);
	}
	pthread_mutex_unlock(&closer->lock);
	if (taken)
		return;
	free(work);
	close(thing);
}
