/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "demo_client.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "client/pursuit.h"
#include "daemon/clock.h"
#include "figures.h"

#define ATTACH_LIMIT_NS UINT64_C(30000000000)
#define MAX_TIMES 65536u
#define LEAST_FRAMES 6u

struct demo_client {
	struct demo_client_params params;
	struct pursuit_stream *stream;
	struct pursuit_gl *gl;
	uint64_t epoch_ns;
	uint64_t next;     /* index of the next frame on the grid */
	uint64_t previous; /* of the one submitted last */
	uint64_t submitted, skipped;
	bool quit;                     /* by key */
	double *render_ms, *submit_us; /* the first MAX_TIMES of them */
	uint32_t times;
};

static int wait_for_attach(struct demo_client *client, struct error *error)
{
	uint64_t start = clock_monotonic_ns();
	struct pursuit_status status;
	do {
		pursuit_update(client->stream);
		pursuit_get_status(client->stream, &status);
		if (status.state == PURSUIT_STATE_ATTACHED)
			return 0;
		clock_monotonic_wait(clock_monotonic_ns() + 5000000);
	} while (status.state != PURSUIT_STATE_REFUSED && clock_monotonic_ns() - start < ATTACH_LIMIT_NS);
	return error_set(error, -ETIMEDOUT, "the daemon did not take the stream: %s", status.message);
}

static int open_stream(struct demo_client *client, bool has_ui, const struct scene_camera *camera, struct error *error)
{
	const struct pursuit_stream_params params = {
		.width = client->params.size.width,
		.height = client->params.size.height,
		.color_format = PURSUIT_COLOR_BGRA8,
		.depth_format = PURSUIT_DEPTH_FLOAT32,
		.near_distance = camera->near_distance,
		.far_distance = camera->far_distance,
		.motion_format = PURSUIT_MOTION_FLOAT16,
		.ui_format = has_ui ? PURSUIT_UI_BGRA8 : PURSUIT_UI_ABSENT,
		.socket_path = client->params.socket,
		.name = "pursuit demo",
		.wants_keys = 1,
	};
	client->stream = pursuit_open(&params);
	if (!client->stream)
		return error_set(error, -errno, "no stream: %s", strerror(errno));
	client->gl = pursuit_gl_create(client->stream, scene_source_lookup(client->params.source));
	if (!client->gl)
		return error_set(error, -errno, "the scene cannot be read back here: %s", strerror(errno));
	return wait_for_attach(client, error);
}

struct demo_client *demo_client_create(const struct demo_client_params *params, struct error *error)
{
	struct scene_textures textures;
	struct scene_camera camera;
	struct demo_client *client = calloc(1, sizeof(*client));
	error_set(error, -ENOMEM, "out of memory");
	if (!client)
		return NULL;
	client->params = *params;
	client->render_ms = calloc(MAX_TIMES, sizeof(double));
	client->submit_us = calloc(MAX_TIMES, sizeof(double));
	if (client->render_ms && client->submit_us) {
		if (!scene_source_render(params->source, 0, 0, &textures, &camera))
			error_set(error, -EIO, "GL failed to render the scene");
		else if (open_stream(client, textures.ui != 0, &camera, error) == 0)
			return client;
	}
	demo_client_destroy(&client);
	return NULL;
}

void demo_client_destroy(struct demo_client **client)
{
	if (!client || !*client)
		return;
	pursuit_gl_destroy(&(*client)->gl);
	pursuit_close(&(*client)->stream);
	free((*client)->render_ms);
	free((*client)->submit_us);
	free(*client);
	*client = NULL;
}

static void note_times(struct demo_client *client, uint64_t start, uint64_t rendered, uint64_t submitted)
{
	if (client->times == MAX_TIMES)
		return;
	client->render_ms[client->times] = (double)(rendered - start) / 1e6;
	client->submit_us[client->times++] = (double)(submitted - rendered) / 1e3;
}

static int render_one(struct demo_client *client, uint64_t index, struct error *error)
{
	const struct arg_rate *rate = &client->params.rate;
	double step = (double)rate->denominator / (double)rate->numerator;
	uint64_t before = client->submitted ? client->previous : index - 1; /* wraps for the first: -1 */
	double previous = client->submitted || index ? (double)before * step : -step;
	struct scene_textures textures;
	struct scene_camera camera;
	uint64_t start = clock_monotonic_ns();
	if (!scene_source_render(client->params.source, (double)index * step, previous, &textures, &camera))
		return error_set(error, -EIO, "GL failed to render the scene");
	uint64_t rendered = clock_monotonic_ns();
	struct pursuit_frame frame = {
		.time_ns = client->epoch_ns + scene_source_time(rate, index),
		.flags = PURSUIT_FLAG_MATRICES | (camera.cut ? (uint32_t)PURSUIT_FLAG_CUT : 0u),
	};
	frame.real_interval_ns = client->submitted
								 ? frame.time_ns - client->epoch_ns - scene_source_time(rate, client->previous)
								 : scene_source_time(rate, 1);
	memcpy(frame.view_projection, camera.view_projection, sizeof(frame.view_projection));
	memcpy(frame.previous_view_projection, camera.previous_view_projection, sizeof(frame.previous_view_projection));
	const struct pursuit_gl_textures read = {
		.color = textures.color,
		.depth = textures.depth,
		.motion = textures.backward,
		.ui = textures.ui,
		.bottom_up = 1,
	};
	pursuit_gl_submit(client->gl, &read, &frame);
	note_times(client, start, rendered, clock_monotonic_ns());
	client->previous = index;
	client->submitted++;
	return 0;
}

/* The next moment on the grid that is not over yet; a frame that is late by less than an interval is still rendered. */
static uint64_t next_index(struct demo_client *client)
{
	uint64_t index = client->next, now = clock_monotonic_ns();
	while (client->epoch_ns + scene_source_time(&client->params.rate, index + 1) <= now)
		index++;
	client->skipped += index - client->next;
	return index;
}

static bool asks_to_end(uint32_t code)
{
	return code == 'q' || code == 27 || code == PURSUIT_KEY_CODE_CLOSE;
}

static void take_keys(struct demo_client *client)
{
	struct pursuit_key key;
	while (pursuit_next_key(client->stream, &key)) {
		if (asks_to_end(key.code))
			client->quit = true;
		else if (client->params.note)
			client->params.note(client->params.context, ((double)key.time_ns - (double)client->epoch_ns) / 1e9,
								key.code);
	}
}

static void tell_frame(const struct demo_client *client)
{
	if (client->params.note)
		client->params.note(client->params.context,
							(double)scene_source_time(&client->params.rate, client->previous) / 1e9, 0);
}

bool demo_client_was_quit(const struct demo_client *client)
{
	return client->quit;
}

int demo_client_run(struct demo_client *client, double seconds, bool (*stop)(void *context), void *context,
					struct error *error)
{
	struct pursuit_feedback_report report;
	if (client->submitted == 0)
		client->epoch_ns = clock_monotonic_ns() + 10000000;
	else
		client->next = next_index(client);
	const uint64_t end = clock_monotonic_ns() + (uint64_t)(seconds * 1e9), enough = client->submitted + LEAST_FRAMES;
	int result = 0;
	while (result == 0 && (clock_monotonic_ns() < end || client->submitted < enough) && !stop(context)) {
		if (client->submitted)
			client->next = next_index(client);
		clock_monotonic_wait(client->epoch_ns + scene_source_time(&client->params.rate, client->next));
		take_keys(client);
		result = render_one(client, client->next++, error);
		tell_frame(client);
		while (pursuit_poll_feedback(client->stream, &report))
			;
	}
	return result;
}

uint64_t demo_client_epoch(const struct demo_client *client)
{
	return client->epoch_ns;
}

static json_t *spread(double *values, uint32_t count)
{
	double p50 = figures_percentile(values, count, 50), p99 = figures_percentile(values, count, 99);
	return json_pack("{s:f, s:f}", "p50", p50, "p99", p99);
}

json_t *demo_client_json(struct demo_client *client)
{
	struct pursuit_status status;
	pursuit_get_status(client->stream, &status);
	double copied = client->submitted ? (double)status.bytes_copied / (double)client->submitted : 0;
	return json_pack("{s:I, s:I, s:I, s:I, s:o, s:o, s:f}", "submitted_frames", (json_int_t)client->submitted,
					 "skipped_frames", (json_int_t)client->skipped, "published_frames", (json_int_t)status.published,
					 "no_slot", (json_int_t)status.no_slot, "render_ms", spread(client->render_ms, client->times),
					 "submit_us", spread(client->submit_us, client->times), "bytes_copied_per_frame", copied);
}
