/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The executor that draws with GL: what its passes share. */
#ifndef PURSUIT_ENGINE_GL_EXECUTOR_GL_H
#define PURSUIT_ENGINE_GL_EXECUTOR_GL_H

#include "daemon/engine/contents.h"
#include "daemon/engine/gl/analysis.h"
#include "daemon/engine/gl/context.h"
#include "daemon/engine/gl/layers.h"
#include "daemon/engine/gl/program.h"
#include "daemon/engine/gl/readback.h"
#include "daemon/engine/gl/shown.h"
#include "daemon/engine/gl/stream.h"
#include "daemon/engine/gl/target.h"
#include "daemon/engine/gl/tile_hash.h"
#include "daemon/engine/gl/timer.h"
#include "daemon/engine/gl/warp_buffers.h"
#include "daemon/engine/state.h"

/* Which tiles the textures of ORIGINAL and UI hold, and what is on its way there: pass_upload.c. */
struct gl_intake {
	struct tile_key key;
	struct tile_hash *hashes[2]; /* by tile of ORIGINAL and of the UI */
	bool hashed[2];              /* that they are what the textures hold */
	size_t tiles;                /* room for so many in each */
	struct tiles sent;           /* of a row of tiles those that are sent */
	uint8_t *rows;               /* a row of tiles, since blocks on their way up may not be read */
	size_t row_bytes;
};

struct executor_gl {
	struct executor base;
	struct context *context;
	struct program_cache programs;
	struct timer timer;
	struct target pictures[PICTURE_COUNT]; /* REAL and BETWEEN have none of their own */
	struct target levels[MAX_LEVELS];      /* levels[i] is level i + 1 of the pyramid */
	struct warp_buffers buffers;
	struct stream stream;
	struct readback readback;
	struct analysis analysis;
	struct gl_intake intake;
	struct contents contents;
	struct tile_buffer level_tiles;
	struct gl_layers layers;
	struct gl_shown shown;
	struct tiles leaving;            /* of the picture that goes out: those that the image does not have */
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

/* Where a picture is drawn to; to be read it has to be asked for with gl_picture(). */
static inline struct target *picture_of(const struct engine *engine, enum picture_id id)
{
	return &gl_of(engine)->pictures[id];
}

/*
 * The picture of that name, ready to be read; of ORIGINAL, REAL and BETWEEN only the one asked for last is. 0, or a
 * negative errno with a sentence.
 */
int gl_picture(struct engine *engine, enum picture_id id, const struct target **picture, struct error *error);

/*
 * The picture is about to be written to: what an unfinished one still has to read there is asked for. Of ORIGINAL for
 * all that share its texture. 0, or -EIO with a sentence: all is lost.
 */
int gl_settle(struct engine *engine, enum picture_id id, struct error *error);

/*
 * The picture goes out to an image that was left with the number job.held: marks in `leaving` which tiles of it the
 * image does not have; what an unfinished one still has to read is asked for first. gl_close_image() afterwards, if it
 * went well; `bytes`: how many of it went out. 0, or a negative errno with a sentence.
 */
int gl_open_image(struct engine *engine, struct sheet *sheet, struct error *error);
void gl_close_image(struct engine *engine, const struct sheet *sheet, uint64_t bytes);

/*
 * Copies pixels to the same places of another picture of that size, as blending and scissor are set. 0, or -EIO with a
 * sentence.
 */
int gl_copy_tiles(struct engine *engine, const struct target *from, const struct target *to,
				  const struct tile_buffer *tiles, struct error *error);

/* L for the program in use, which makes it of that level of the pyramid. */
void low_bind(const struct engine *engine, const struct program *program, uint32_t level);

extern const struct pass gl_pass_analyse, gl_pass_upload, gl_pass_pyramid, gl_pass_compensate, gl_pass_put,
	gl_pass_warp, gl_pass_ui, gl_pass_read, gl_pass_copy;

#endif
