/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Pixels on their way up to textures, block by block, in GL buffers that take
 * turns: the copy into the texture happens behind the caller's back while the
 * next block is filled. The caller fills them, so that nothing of GL's reads
 * memory that a client may change.
 */
#ifndef PURSUIT_ENGINE_GL_STREAM_H
#define PURSUIT_ENGINE_GL_STREAM_H

#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/gl/gl.h"
#include "daemon/error.h"

/* Blocks that there are soon, and at most: rows of tiles of colour and UI of 3840x2160. */
#define STREAM_BLOCKS 4u
#define STREAM_MOST 140u

struct stream {
	struct stream_block {
		GLuint buffer;
		size_t bytes;
		GLsync busy; /* the copy out of it; NULL: none */
	} blocks[STREAM_MOST];
	uint32_t made, next; /* the next one is the oldest */
	uint32_t wished;     /* by stream_widen() */
	uint64_t waits;      /* blocks that were still being read when it was their turn */
};

/* A rectangle of the texture that is bound, and where in the block its rows begin, one after another. */
struct stream_target {
	GLint x, y;
	GLsizei width, rows;
	GLenum format, type;
	size_t offset;
};

/* A zeroed stream is ready for use. */
void stream_finish(struct stream *stream, const struct gl *gl);

/*
 * From now on so many blocks at a time go up without waiting for what the renderer has to do before: where none is free
 * when it is its turn there will be another one.
 */
void stream_widen(struct stream *stream, uint32_t blocks);

/* How many rows of that many bytes a block takes, at least 1. */
uint32_t stream_rows(size_t row_bytes);

/* Memory for `bytes`, to be written and not read; NULL with a sentence. stream_send() follows. */
uint8_t *stream_begin(struct stream *stream, const struct gl *gl, size_t bytes, struct error *error);

/* Sends it, to `count` rectangles. 0, or -EIO with a sentence: GL has lost what was written. */
int stream_send(struct stream *stream, const struct gl *gl, const struct stream_target *targets, uint32_t count,
				struct error *error);

/* Bytes that it holds in GL buffers. */
uint64_t stream_bytes(const struct stream *stream);

#endif
