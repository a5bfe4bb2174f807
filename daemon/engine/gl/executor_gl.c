/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>
#include <stdlib.h>

#include "daemon/engine/pass.h"
#include "daemon/engine/pool.h"

static struct executor_gl *self(struct executor *executor)
{
	return (struct executor_gl *)executor;
}

static const struct gl *table(struct executor *executor)
{
	return &self(executor)->context->gl;
}

/* State that every draw relies on and none changes for good. */
static void set_up(struct executor_gl *executor)
{
	const struct gl *gl = &executor->context->gl;
	gl->GenVertexArrays(1, &executor->no_attributes);
	gl->FrontFace(GL_CCW);
	gl->CullFace(GL_BACK);
	gl->DepthFunc(GL_LESS);
	gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

static int enter(struct executor *executor, struct error *error)
{
	return context_enter(self(executor)->context, error);
}

static void delete_objects(struct executor_gl *executor)
{
	const struct gl *gl = &executor->context->gl;
	for (int i = 0; i < PICTURE_COUNT; i++)
		target_finish(&executor->pictures[i], gl);
	for (int i = 0; i < MAX_LEVELS; i++)
		target_finish(&executor->levels[i], gl);
	gl->DeleteFramebuffers(1, &executor->depth_framebuffer);
	gl->DeleteFramebuffers(1, &executor->copy_framebuffer);
	gl->DeleteRenderbuffers(1, &executor->depth);
	gl->DeleteVertexArrays(1, &executor->no_attributes);
	tile_buffer_finish(&executor->level_tiles, gl);
	gl_layers_finish(&executor->layers, gl);
	gl_shown_finish(&executor->shown, gl);
	warp_buffers_finish(&executor->buffers, gl);
	stream_finish(&executor->stream, gl);
	readback_finish(&executor->readback, gl);
	analysis_finish(&executor->analysis, gl);
	program_cache_finish(&executor->programs, gl);
	timer_finish(&executor->timer, gl);
}

static void destroy(struct executor **executor)
{
	struct executor_gl *gone = self(*executor);
	struct error error;
	/* A lost context ignores the calls. */
	context_enter(gone->context, &error);
	delete_objects(gone);
	context_destroy(&gone->context);
	pool_destroy(&gone->base.pool);
	contents_finish(&gone->contents);
	tiles_finish(&gone->leaving);
	free(gone->intake.hashes[0]);
	free(gone->intake.hashes[1]);
	free(gone->intake.rows);
	tiles_finish(&gone->intake.sent);
	free(gone);
	*executor = NULL;
}

static void leave(struct executor *executor)
{
	context_leave(self(executor)->context);
}

/* GL has copied what it was given. */
static void release_planes(struct engine *engine)
{
}

static void flush(struct executor *executor)
{
	table(executor)->Flush();
}

static int finish(struct executor *executor, struct error *error)
{
	const struct gl *gl = table(executor);
	const GLsync fence = gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
	const int result = gl_wait(gl, fence, error);
	gl->DeleteSync(fence);
	return result;
}

static int receive(struct executor *executor, struct arrival *arrival, struct error *error)
{
	return readback_receive(&self(executor)->readback, table(executor), arrival, error);
}

static void forget(struct executor *executor)
{
	readback_forget(&self(executor)->readback, table(executor));
}

static void time_begin(struct executor *executor, struct engine_pass_report *pass, bool on_cpu)
{
	timer_begin(&self(executor)->timer, table(executor), pass, on_cpu);
}

static void time_end(struct executor *executor)
{
	timer_end(&self(executor)->timer, table(executor));
}

static uint64_t count_bytes(const struct executor_gl *executor)
{
	uint64_t bytes = 4 * (uint64_t)executor->depth_width * executor->depth_height;
	for (int i = 0; i < PICTURE_COUNT; i++)
		bytes += target_bytes(&executor->pictures[i]);
	for (int i = 0; i < MAX_LEVELS; i++)
		bytes += target_bytes(&executor->levels[i]);
	bytes += executor->buffers.vertices.bytes + executor->buffers.indices.bytes;
	bytes += executor->level_tiles.vertices.bytes + gl_layers_bytes(&executor->layers);
	bytes += executor->shown.rectangles.vertices.bytes;
	bytes += stream_bytes(&executor->stream) + readback_bytes(&executor->readback);
	return bytes + analysis_bytes(&executor->analysis);
}

static void collect_times(struct executor *executor)
{
	struct error error;
	executor->bytes = count_bytes(self(executor));
	if (self(executor)->timer.pending && enter(executor, &error) == 0)
		timer_collect(&self(executor)->timer, table(executor));
}

static void drop_times(struct executor *executor)
{
	timer_drop(&self(executor)->timer);
}

static const char *time_source(const struct executor *executor)
{
	return timer_source(&((const struct executor_gl *)executor)->timer);
}

static const struct executor_ops ops = {
	.passes =
		{
			[PASS_ANALYSE] = &gl_pass_analyse,
			[PASS_FIELD] = &pass_field,
			[PASS_PAINT] = &pass_paint,
			[PASS_PUT] = &gl_pass_put,
			[PASS_UPLOAD] = &gl_pass_upload,
			[PASS_PYRAMID] = &gl_pass_pyramid,
			[PASS_COMPENSATE] = &gl_pass_compensate,
			[PASS_WARP] = &gl_pass_warp,
			[PASS_UI] = &gl_pass_ui,
			[PASS_READ] = &gl_pass_read,
			[PASS_COPY] = &gl_pass_copy,
		},
	.enter = enter,
	.leave = leave,
	.destroy = destroy,
	.release_planes = release_planes,
	.flush = flush,
	.finish = finish,
	.receive = receive,
	.forget = forget,
	.time_begin = time_begin,
	.time_end = time_end,
	.collect_times = collect_times,
	.drop_times = drop_times,
	.time_source = time_source,
};

struct executor *executor_gl_create(const struct engine_params *params, struct error *error)
{
	struct executor_gl *executor = calloc(1, sizeof(*executor));
	if (!executor) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	executor->context = context_create(params, error);
	if (!executor->context) {
		free(executor);
		return NULL;
	}
	executor->base.ops = &ops;
	struct executor *made = &executor->base;
	if (tile_key_make(&executor->intake.key, error) < 0) {
		destroy(&made);
		return NULL;
	}
	executor->base.info = executor->context->info;
	const uint32_t most = (uint32_t)executor->context->gl.max_size;
	executor->base.max_size = most < PURSUIT_MAX_SIZE ? most : PURSUIT_MAX_SIZE;
	timer_init(&executor->timer, &executor->context->gl, !executor->base.info.software || params->query_software,
			   params->finish_each_pass);
	executor->readback.buffered = !executor->base.info.software || params->buffer_software;
	/* For what the CPU does here; without it, the caller does all. */
	executor->base.pool = pool_create(params->threads);
	set_up(executor);
	return &executor->base;
}
