/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine_maker.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "daemon/notify.h"
#include "daemon/slices.h"

#define PATIENCE_S 10

/* Belongs to both sides; who is second frees it. */
struct making {
	struct settings settings;
	const struct log *log;
	pthread_mutex_t lock;
	pthread_cond_t wake;
	bool made, given_up;
	struct engine *engine; /* NULL with the sentence */
	struct error error;
};

static void free_making(struct making *making)
{
	engine_destroy(&making->engine);
	pthread_cond_destroy(&making->wake);
	pthread_mutex_destroy(&making->lock);
	free(making);
}

static struct engine *make(struct making *making)
{
	struct engine_params params;
	if (settings_engine_params(&making->settings, &params, &making->error) < 0)
		return NULL;
	struct engine *engine = engine_create(&params, &making->error);
	if (engine)
		engine_leave(engine);
	return engine;
}

static void *run(void *data)
{
	struct making *making = data;
	pthread_setname_np(pthread_self(), "pursuit-engine");
	slices_shorten(making->log);
	struct engine *engine = make(making);
	pthread_mutex_lock(&making->lock);
	making->engine = engine;
	making->made = true;
	const bool given_up = making->given_up;
	pthread_cond_signal(&making->wake);
	pthread_mutex_unlock(&making->lock);
	if (given_up)
		free_making(making);
	return NULL;
}

static struct making *start(const struct settings *settings, const struct log *log, struct error *error)
{
	struct making *making = calloc(1, sizeof(*making));
	pthread_condattr_t attributes;
	pthread_t thread;
	if (!making) {
		error_set(error, -ENOMEM, "context: out of memory");
		return NULL;
	}
	making->settings = *settings;
	making->log = log;
	pthread_mutex_init(&making->lock, NULL);
	pthread_condattr_init(&attributes);
	pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
	pthread_cond_init(&making->wake, &attributes);
	pthread_condattr_destroy(&attributes);
	const int result = pthread_create(&thread, NULL, run, making);
	if (result == 0) {
		pthread_detach(thread);
		return making;
	}
	error_set(error, -result, "context: no thread to make an engine on: %s", strerror(result));
	free_making(making);
	return NULL;
}

/* With the lock. Main waits here, and not for ever: what watches it is told each second. */
static bool wait_for_engine(struct making *making)
{
	struct timespec until;
	clock_gettime(CLOCK_MONOTONIC, &until);
	for (int second = 0; second < PATIENCE_S && !making->made; second++) {
		notify_send(making->log, "WATCHDOG=1");
		until.tv_sec++;
		while (!making->made && pthread_cond_timedwait(&making->wake, &making->lock, &until) == 0)
			;
	}
	return making->made;
}

struct engine *engine_maker_make(const struct settings *settings, const struct log *log, struct error *error)
{
	struct making *making = start(settings, log, error);
	if (!making)
		return NULL;
	pthread_mutex_lock(&making->lock);
	const bool made = wait_for_engine(making);
	making->given_up = !made;
	pthread_mutex_unlock(&making->lock);
	if (!made) {
		error_set(error, -ETIMEDOUT, "context: \"%.64s\": no engine after %d s; the driver hangs", settings->context,
				  PATIENCE_S);
		return NULL;
	}
	struct engine *engine = making->engine;
	making->engine = NULL;
	*error = making->error;
	free_making(making);
	return engine;
}
