/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/engine.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "daemon/engine/method.h"
#include "daemon/engine/params.h"
#include "daemon/engine/pass.h"
#include "daemon/engine/state.h"
#include "daemon/engine/warm_up.h"

/* State that every draw relies on and none changes for good. */
static void set_up_gl(struct engine *engine)
{
	const struct gl *gl = engine_gl(engine);
	gl->GenVertexArrays(1, &engine->no_attributes);
	gl->FrontFace(GL_CCW);
	gl->CullFace(GL_BACK);
	gl->DepthFunc(GL_LESS);
	gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

static int apply_params(struct engine *engine, const struct engine_params *params, struct error *error)
{
	struct engine_params resolved = *params;
	const struct method *method = method_find(params->method, error);
	if (!method)
		return -EINVAL;
	int result = params_resolve(&resolved, error);
	if (result < 0)
		return result;
	resolved.method = method->name;
	engine->params = resolved;
	engine->method = method;
	return 0;
}

/* So that the first frame is not late. */
static int prepare(struct engine *engine, struct error *error)
{
	int result = warm_up(engine, error);
	engine->begun = false;
	report_begin(&engine->report, 0, timer_source(&engine->timer));
	return result;
}

struct engine *engine_create(const struct engine_params *params, struct error *error)
{
	struct engine *engine = calloc(1, sizeof(*engine));
	if (!engine) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	if (apply_params(engine, params, error) < 0)
		goto fail;
	engine->context = context_create(params, error);
	if (!engine->context)
		goto fail;
	timer_init(&engine->timer, engine_gl(engine), engine->context->info.software, params->finish_each_pass);
	set_up_gl(engine);
	if (prepare(engine, error) < 0)
		goto fail;
	return engine;
fail:
	engine_destroy(&engine);
	return NULL;
}

static void delete_objects(struct engine *engine)
{
	const struct gl *gl = engine_gl(engine);
	struct target *const targets[] = {&engine->color, &engine->real,  &engine->between,
									  &engine->low,   &engine->shown, &engine->ui};
	for (size_t i = 0; i < sizeof(targets) / sizeof(targets[0]); i++)
		target_finish(targets[i], gl);
	for (int i = 0; i < MAX_LEVELS; i++)
		target_finish(&engine->levels[i], gl);
	gl->DeleteFramebuffers(1, &engine->both_framebuffer);
	gl->DeleteFramebuffers(1, &engine->depth_framebuffer);
	gl->DeleteRenderbuffers(1, &engine->depth);
	gl->DeleteVertexArrays(1, &engine->no_attributes);
	gl->DeleteVertexArrays(1, &engine->tile_array);
	gl->DeleteBuffers(1, &engine->tile_vertices);
	warp_mesh_finish(&engine->mesh, gl);
	program_cache_finish(&engine->programs, gl);
	timer_finish(&engine->timer, gl);
}

void engine_destroy(struct engine **engine)
{
	struct engine *gone = *engine;
	if (!gone)
		return;
	struct error error;
	if (gone->context) {
		/* A lost context ignores the calls. */
		context_enter(gone->context, &error);
		delete_objects(gone);
		context_destroy(&gone->context);
	}
	plan_finish(&gone->plan);
	free(gone->staging);
	free(gone->tile_numbers);
	free(gone);
	*engine = NULL;
}

const struct engine_info *engine_get_info(const struct engine *engine)
{
	return &engine->context->info;
}

static int check_size(const struct engine *engine, const struct frame *frame, struct error *error)
{
	uint32_t most = (uint32_t)engine_gl(engine)->max_size;
	for (uint32_t i = 0; i < frame->header.plane_count && i < PURSUIT_MAX_PLANES; i++) {
		const struct pursuit_plane *plane = &frame->header.planes[i];
		if (plane->role != PURSUIT_ROLE_COLOR)
			continue;
		if (plane->width && plane->height && plane->width <= most && plane->height <= most)
			return 0;
		return error_set(error, -EINVAL, "planes[%u] is %u x %u, this renderer takes 1 x 1 to %u x %u", i, plane->width,
						 plane->height, most, most);
	}
	return error_set(error, -EINVAL, "frame %llu has no colour plane", (unsigned long long)frame->header.frame_id);
}

static void begin_frame(struct engine *engine, const struct frame *frame, const struct engine_begin_params *params)
{
	timer_drop(&engine->timer);
	report_begin(&engine->report, frame->header.frame_id, timer_source(&engine->timer));
	engine->job = (struct job){.frame = frame};
	engine->begun = engine->moves = engine->compensated = false;
	engine->levels_made = LEVELS_NONE;
	engine->n = params->n < 1 ? 1 : params->n > 8 ? 8 : params->n;
	engine->real_interval_ns = params->real_interval_ns;
	engine->last_phase = params->last_phase >= 0.0 ? fmin(params->last_phase, 8.0) : (engine->n - 1.0) / engine->n;
}

int engine_begin(struct engine *engine, const struct frame *frame, const struct engine_begin_params *params,
				 struct error *error)
{
	uint64_t began = timer_now_ns();
	int result = context_enter(engine->context, error);
	if (result < 0)
		return result;
	begin_frame(engine, frame, params);
	result = check_size(engine, frame, error);
	if (result == 0)
		result = pass_run(engine, PASS_UPLOAD, error);
	if (result == 0)
		result = engine->method->begin(engine, error);
	engine->begun = result == 0;
	engine->job.frame = NULL;
	engine->report.total_ms += (double)(timer_now_ns() - began) * 1e-6;
	return result;
}

void engine_get_size(const struct engine *engine, uint32_t *width, uint32_t *height)
{
	*width = engine->begun ? engine->color.width : 0;
	*height = engine->begun ? engine->color.height : 0;
}

static int check_request(const struct engine *engine, const struct engine_image *image, struct error *error)
{
	if (!engine->begun)
		return error_set(error, -EINVAL, "there is no frame to show yet");
	if (image->data && (image->stride % 4 || image->stride < 4 * (size_t)engine->color.width))
		return error_set(error, -EINVAL, "the image's stride is %zu, must be a multiple of 4 and at least %zu",
						 image->stride, 4 * (size_t)engine->color.width);
	return 0;
}

static int show(struct engine *engine, const struct engine_request *request, struct engine_image *image,
				struct error *error)
{
	double phase = isnan(request->phase) ? 0.0 : fmin(fmax(request->phase, -1.0), 8.0);
	const struct target *picture = NULL;
	int result = engine->method->show(engine, request->show, phase, &picture, error);
	if (result < 0)
		return result;
	engine->job.picture = picture;
	result = pass_run(engine, PASS_UI, error);
	engine->job.image = image;
	if (result == 0 && image->data)
		result = pass_run(engine, PASS_READ, error);
	else
		engine_gl(engine)->Flush();
	return result;
}

int engine_render(struct engine *engine, const struct engine_request *request, struct engine_image *image,
				  struct error *error)
{
	uint64_t began = timer_now_ns();
	int result = check_request(engine, image, error);
	if (result == 0)
		result = context_enter(engine->context, error);
	if (result < 0)
		return result;
	result = show(engine, request, image, error);
	engine->report.total_ms += (double)(timer_now_ns() - began) * 1e-6;
	return result;
}

const struct engine_report *engine_get_report(struct engine *engine)
{
	struct error error;
	if (engine->timer.pending && context_enter(engine->context, &error) == 0)
		timer_collect(&engine->timer, engine_gl(engine));
	return &engine->report;
}

int engine_set_params(struct engine *engine, const struct engine_params *params, struct error *error)
{
	return apply_params(engine, params, error);
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
