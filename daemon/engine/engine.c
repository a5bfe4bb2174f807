/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/engine.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "daemon/engine/method.h"
#include "daemon/engine/now.h"
#include "daemon/engine/params.h"
#include "daemon/engine/pass.h"
#include "daemon/engine/state.h"
#include "daemon/engine/warm_up.h"

static void resolve_method(struct engine_params *params, const struct method *method)
{
	params->method = method->name;
	if (method->halves_cells)
		params->cell = params->cell / 2 > 4 ? params->cell / 2 : 4;
	if (method->blurs_everywhere && params->blur == ENGINE_BLUR_DOUBTFUL)
		params->blur = ENGINE_BLUR_EVERYWHERE;
}

int engine_set_params(struct engine *engine, const struct engine_params *params, struct error *error)
{
	struct next_params *next = &engine->next;
	struct engine_params resolved = *params;
	const struct method *method = method_find(params->method, error);
	if (!method)
		return -EINVAL;
	int result = params_resolve(&resolved, error);
	if (result < 0)
		return result;
	resolve_method(&resolved, method);
	const bool other = method != (next->method ? next->method : engine->method);
	next->forgets_pixels |= other;
	next->forgets_bend |= other || resolved.motion_model == ENGINE_MOTION_LINEAR;
	next->params = resolved;
	next->method = method;
	return 0;
}

/* The frame begun last is shown no more: what comes is made as was asked for. */
static void take_next_params(struct engine *engine)
{
	const struct next_params next = engine->next;
	if (!next.method)
		return;
	/* What another method kept is not the frame before. */
	if (next.forgets_pixels)
		pixel_state_forget(&engine->pixels);
	if (next.forgets_bend)
		bend_forget(&engine->bend);
	engine->params = next.params;
	engine->method = next.method;
	engine->stream = 0;
	engine->next = (struct next_params){.method = NULL};
}

/* So that the first frame is not late. */
static int prepare(struct engine *engine, struct error *error)
{
	int result = warm_up(engine, error);
	engine->begun = false;
	pixel_state_forget(&engine->pixels);
	bend_forget(&engine->bend);
	report_begin(&engine->report, 0, engine->executor->ops->time_source(engine->executor));
	return result;
}

struct engine *engine_create(const struct engine_params *params, struct error *error)
{
	struct engine *engine = calloc(1, sizeof(*engine));
	if (!engine) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	if (engine_set_params(engine, params, error) < 0)
		goto fail;
	take_next_params(engine);
	engine->executor = executor_create(&engine->params, error);
	if (!engine->executor)
		goto fail;
	if (prepare(engine, error) < 0)
		goto fail;
	return engine;
fail:
	engine_destroy(&engine);
	return NULL;
}

void engine_destroy(struct engine **engine)
{
	struct engine *gone = *engine;
	if (!gone)
		return;
	executor_destroy(&gone->executor);
	warp_mesh_finish(&gone->mesh);
	pixel_state_finish(&gone->pixels);
	bend_finish(&gone->bend);
	plan_finish(&gone->plan);
	free(gone);
	*engine = NULL;
}

void engine_leave(struct engine *engine)
{
	engine->executor->ops->leave(engine->executor);
}

const struct engine_info *engine_get_info(const struct engine *engine)
{
	return &engine->executor->info;
}

static void begin_frame(struct engine *engine, const struct frame *frame, const struct engine_begin_params *params)
{
	struct executor *executor = engine->executor;
	take_next_params(engine);
	executor->ops->drop_times(executor);
	report_begin(&engine->report, frame->header.frame_id, executor->ops->time_source(executor));
	/* A frame of another stream is not the frame before. */
	if (engine->sequence != frame->stream) {
		pixel_state_forget(&engine->pixels);
		bend_forget(&engine->bend);
	}
	engine->sequence = frame->stream;
	engine->job = (struct job){.frame = frame};
	engine->rested = engine->begun && !engine->moves && !engine->compensated;
	engine->begun = engine->moves = engine->compensated = false;
	engine->levels_made = LEVELS_NONE;
	engine->n = params->n < 1 ? 1 : params->n > 8 ? 8 : params->n;
	engine->real_interval_ns = params->real_interval_ns;
	engine->last_phase = params->last_phase >= 0.0 ? fmin(params->last_phase, 8.0) : (engine->n - 1.0) / engine->n;
}

int engine_begin(struct engine *engine, const struct frame *frame, const struct engine_begin_params *params,
				 struct error *error)
{
	uint64_t began = now_ns();
	int result = engine->executor->ops->enter(engine->executor, error);
	if (result < 0)
		return result;
	begin_frame(engine, frame, params);
	result = pass_run(engine, PASS_UPLOAD, error);
	if (result == 0)
		result = engine->method->begin(engine, error);
	engine->executor->ops->release_planes(engine);
	engine->begun = result == 0;
	if (result < 0)
		engine->stream = 0;
	engine->job.frame = NULL;
	engine->report.total_ms += (double)(now_ns() - began) * 1e-6;
	return result;
}

void engine_get_size(const struct engine *engine, uint32_t *width, uint32_t *height)
{
	*width = engine->begun ? engine->width : 0;
	*height = engine->begun ? engine->height : 0;
}

static int check_request(const struct engine *engine, const struct engine_image *image, struct error *error)
{
	if (!engine->begun)
		return error_set(error, -EINVAL, "there is no frame to show yet");
	if (image->data && (image->stride % 4 || image->stride < 4 * (size_t)engine->width))
		return error_set(error, -EINVAL, "the image's stride is %zu, must be a multiple of 4 and at least %zu",
						 image->stride, 4 * (size_t)engine->width);
	if (!image->data && image->texture && !engine->executor->info.brought)
		return error_set(error, -EINVAL, "the image is a texture, but the engine's context is its own");
	return arrivals_check(&engine->arrivals, image, engine->width, engine->height, error);
}

static int show(struct engine *engine, const struct engine_request *request, struct engine_image *image,
				struct error *error)
{
	double phase = isnan(request->phase) ? 0.0 : fmin(fmax(request->phase, -1.0), 8.0);
	enum picture_id picture = PICTURE_ORIGINAL;
	engine->job.image = image;
	engine->job.held = image->holds;
	image->holds = 0;
	int result = engine->method->show(engine, request->show, phase, &picture, error);
	if (result < 0)
		return result;
	engine->job.picture = picture;
	engine->job.holds = picture == PICTURE_ORIGINAL ? engine->content : 0;
	const enum pass_id leave = image->data ? PASS_READ : PASS_COPY;
	const bool leaves = image->data || image->texture;
	if (leaves && engine->job.holds && engine->job.holds == engine->job.held) {
		report_leave_out(&engine->report, leave == PASS_READ ? "read" : "copy", "unchanged");
		engine->report.bytes_kept += 4 * (uint64_t)engine->width * engine->height;
		image->holds = engine->job.holds;
		return 0;
	}
	result = pass_run(engine, PASS_UI, error);
	if (result == 0 && leaves)
		result = pass_run(engine, leave, error);
	if (result == 0 && leaves)
		image->holds = engine->job.holds;
	else
		engine->executor->ops->flush(engine->executor);
	return result;
}

/* What it will hold is known, but not told before it does. */
static int ask(struct engine *engine, const struct engine_request *request, struct engine_image *image,
			   struct error *error)
{
	struct arrival *arrival = arrivals_next(&engine->arrivals);
	*arrival = (struct arrival){.image = *image, .width = engine->width, .height = engine->height};
	image->holds = 0;
	engine->job.arrival = arrival;
	const int result = show(engine, request, &arrival->image, error);
	engine->job.arrival = NULL;
	engine->arrivals.count += result == 0;
	return result;
}

int engine_render(struct engine *engine, const struct engine_request *request, struct engine_image *image,
				  struct error *error)
{
	uint64_t began = now_ns();
	int result = check_request(engine, image, error);
	if (result == 0)
		result = engine->executor->ops->enter(engine->executor, error);
	if (result < 0)
		return result;
	if (image->data && image->unfinished)
		result = ask(engine, request, image, error);
	else
		result = show(engine, request, image, error);
	engine->job.image = NULL;
	engine->report.total_ms += (double)(now_ns() - began) * 1e-6;
	return result;
}

int engine_finish(struct engine *engine, struct error *error)
{
	const uint64_t began = now_ns();
	int result = engine->executor->ops->enter(engine->executor, error);
	for (uint32_t i = 0; i < engine->arrivals.count && result == 0; i++)
		result = engine->executor->ops->receive(engine->executor, arrivals_at(&engine->arrivals, i), error);
	if (result == 0)
		result = engine->executor->ops->finish(engine->executor, error);
	engine->report.total_ms += (double)(now_ns() - began) * 1e-6;
	return result;
}

const struct engine_report *engine_get_report(struct engine *engine)
{
	engine->executor->ops->collect_times(engine->executor);
	engine->report.memory_bytes = engine->executor->bytes;
	engine->report.plan_bytes = plan_bytes(&engine->plan) + warp_mesh_bytes(&engine->mesh) +
								pixel_state_bytes(&engine->pixels) + bend_bytes(&engine->bend);
	return &engine->report;
}

void engine_print_plan(const struct engine *engine, char *text, size_t size)
{
	if (!size)
		return;
	text[0] = '\0';
	if (!engine->begun || !engine->plan.width)
		return;
	FILE *out = fmemopen(text, size, "w");
	if (!out)
		return;
	plan_print(&engine->plan, out);
	fclose(out);
	text[size - 1] = '\0';
}
