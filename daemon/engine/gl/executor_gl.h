/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The executor that draws with GL: what its passes share. */
#ifndef PURSUIT_ENGINE_GL_EXECUTOR_GL_H
#define PURSUIT_ENGINE_GL_EXECUTOR_GL_H

#include "daemon/engine/gl/analysis.h"
#include "daemon/engine/gl/context.h"
#include "daemon/engine/gl/program.h"
#include "daemon/engine/gl/stream.h"
#include "daemon/engine/gl/target.h"
#include "daemon/engine/gl/timer.h"
#include "daemon/engine/gl/warp_buffers.h"
#include "daemon/engine/state.h"

struct executor_gl {
	struct executor base;
	struct context *context;
	struct program_cache programs;
	struct timer timer;
	struct target pictures[PICTURE_COUNT];
	struct target levels[MAX_LEVELS]; /* levels[i] is level i + 1 of the pyramid */
	struct warp_buffers buffers;
	struct stream stream;
	struct analysis analysis;
	uint8_t *row; /* of the UI */
	size_t row_bytes;
	GLuint tile_array, tile_vertices; /* rectangles to fill */
	float *tile_numbers;              /* on their way there */
	size_t tile_capacity;
	GLuint both_framebuffer;         /* REAL and BETWEEN at once */
	GLuint copy_framebuffer;         /* of the texture that a picture is copied to */
	GLuint no_attributes;            /* a vertex array with nothing in it */
	GLuint depth, depth_framebuffer; /* SHOWN with depth; 0 until the first fold */
	uint32_t depth_width, depth_height;
};

static inline struct executor_gl *gl_of(const struct engine *engine)
{
	return (struct executor_gl *)engine->executor;
}

static inline const struct gl *table_of(const struct engine *engine)
{
	return &gl_of(engine)->context->gl;
}

static inline struct target *picture_of(const struct engine *engine, enum picture_id id)
{
	return &gl_of(engine)->pictures[id];
}

extern const struct pass gl_pass_analyse, gl_pass_upload, gl_pass_pyramid, gl_pass_compensate, gl_pass_put,
	gl_pass_warp, gl_pass_ui, gl_pass_read, gl_pass_copy;

#endif
