/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The game of the demo: renders a built-in scene in real time, on an absolute
 * grid of times, and submits it through libpursuit's GL helper. One thread.
 */
#ifndef PURSUIT_CLI_DEMO_CLIENT_H
#define PURSUIT_CLI_DEMO_CLIENT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "scene_source.h"

struct demo_client_params {
	struct scene_source *source; /* the caller's; its context is used */
	struct arg_size size;
	struct arg_rate rate;
	const char *socket;
	/*
	 * A key that does not end the run was pressed at `time`, or a frame of that time was rendered (key 0); seconds of
	 * the scene. NULL: nobody wants to know.
	 */
	void (*note)(void *context, double time, uint32_t key);
	void *context;
};

struct demo_client;

/* Renders once, so that all shaders are compiled, and waits until the daemon has attached the stream. */
struct demo_client *demo_client_create(const struct demo_client_params *params, struct error *error);
void demo_client_destroy(struct demo_client **client);

/*
 * Goes on rendering for so many seconds, and where a machine is slow until there is something to show, which takes
 * six frames; stops early when `stop` says so (asked once a frame).
 */
int demo_client_run(struct demo_client *client, double seconds, bool (*stop)(void *context), void *context,
					struct error *error);

/* Was it asked to end, by a key in the daemon's window? */
bool demo_client_was_quit(const struct demo_client *client);

/* CLOCK_MONOTONIC of the scene's time 0. */
uint64_t demo_client_epoch(const struct demo_client *client);

/*
 * {"submitted_frames", "skipped_frames", "render_ms", "submit_us", ...}: the time to give the frame's work to GL, and
 * that of pursuit_gl_submit(), in which a CPU renderer draws the frame and reads it back.
 */
json_t *demo_client_json(struct demo_client *client);

#endif
