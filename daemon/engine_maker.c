/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine_maker.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/notify.h"
#include "daemon/slices.h"
#include "daemon/worker.h"

#define PATIENCE_S 10
#define SECOND UINT64_C(1000000000)

/* The thread's until it has ended. */
struct making {
	struct settings settings;
	const struct log *log;
	struct engine *engine; /* NULL with the sentence */
	struct error error;
};

static void free_making(void *data)
{
	struct making *making = data;
	engine_destroy(&making->engine);
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

static void run(void *data)
{
	struct making *making = data;
	pthread_setname_np(pthread_self(), "pursuit-engine");
	slices_shorten(making->log);
	making->engine = make(making);
}

/* Main waits here, and not for ever: what watches it is told each second. */
static bool wait_for_engine(struct worker **worker, struct making *making)
{
	const struct log *log = making->log;
	bool made = false;
	for (int second = 0; second < PATIENCE_S && !made; second++) {
		notify_send(log, "WATCHDOG=1");
		made = worker_wait(*worker, SECOND);
	}
	return worker_destroy(worker, 0, free_making);
}

struct engine *engine_maker_make(const struct settings *settings, const struct log *log, struct error *error)
{
	struct making *making = calloc(1, sizeof(*making));
	struct worker *worker;
	if (!making) {
		error_set(error, -ENOMEM, "context: out of memory");
		return NULL;
	}
	making->settings = *settings;
	making->log = log;
	const int result = worker_create(&worker, run, making);
	if (result < 0) {
		free_making(making);
		error_set(error, result, "context: no thread to make an engine on: %s", strerror(-result));
		return NULL;
	}
	if (!wait_for_engine(&worker, making)) {
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
