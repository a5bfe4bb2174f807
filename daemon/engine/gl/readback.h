/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Pixels on their way back from the framebuffer that is bound for reading, rows as they lie. On a GPU by way of GL
 * buffers, block by block: it fills them while the CPU copies others to where they belong, or does something else. Each
 * block holds what was there when it was asked for, whatever is drawn afterwards. A picture that nobody waits for is
 * asked for as far as there are blocks; the rest follows as others come back, or when the framebuffer is about to be
 * drawn to. A CPU renderer writes to where the pixels belong itself.
 */
#ifndef PURSUIT_ENGINE_GL_READBACK_H
#define PURSUIT_ENGINE_GL_READBACK_H

#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/arrival.h"
#include "daemon/engine/gl/gl.h"
#include "daemon/engine/tiles.h"
#include "daemon/error.h"

/* Bytes; a row of the widest picture is less. */
#define READBACK_BLOCK ((size_t)512 * 1024)
/* Blocks for pictures that somebody waits for. */
#define READBACK_BLOCKS 4u
/* With pictures that nobody waits for: blocks for one, and these. */
#define READBACK_SPARE 2u
/* At most: of pictures larger than 3840x2160 some rows are always asked for later. */
#define READBACK_MOST 128u

/* Rectangles of a block: as many tiles as fill it. */
#define READBACK_PIECES 64u

/* A rectangle in a buffer, one row after another, and where it belongs. */
struct readback_piece {
	size_t offset; /* in the buffer */
	uint8_t *data;
	size_t stride, row_bytes;
	uint32_t rows;
};

struct readback_block {
	GLuint buffer;
	GLsync filled; /* NULL: it never will be */
	struct readback_piece pieces[READBACK_PIECES];
	uint32_t count;
	size_t bytes; /* in use */
	struct arrival *arrival;
};

struct readback_image {
	uint8_t *data;
	size_t stride;             /* bytes, a multiple of 4 */
	const struct tiles *tiles; /* of the picture: those that are marked are read */
	GLuint framebuffer;        /* where it is */
};

/* What is not yet asked for. */
struct readback_rest {
	struct arrival *arrival; /* NULL: nothing */
	struct readback_image image;
	struct bounds bounds;        /* of the rectangle at work */
	uint32_t top;                /* its first row that is not asked for */
	struct readback_block *open; /* that has room yet; NULL: none */
	uint32_t limit;              /* blocks that may be under way */
};

/* A zeroed one is ready for use. */
struct readback {
	bool buffered;
	struct readback_block blocks[READBACK_MOST]; /* under way: `count` from `first` on, around, the oldest first */
	uint32_t first, count;
	GLuint spare[READBACK_MOST]; /* buffers */
	uint32_t spare_count;
	struct readback_rest rest;
};

/*
 * Asks for pixels of an image, counts in `arrival` what is missing, and adds to *bytes how many come; ahead: waits for
 * none, but leaves a rest for which there are no blocks; else waits for blocks enough to ask for all. Nothing else is
 * left to ask for: readback_settle(). 0, or -EIO with a sentence: all that was under way is lost.
 */
int readback_ask(struct readback *readback, const struct gl *gl, const struct readback_image *image,
				 struct arrival *arrival, bool ahead, uint64_t *bytes, struct error *error);

/*
 * That framebuffer, 0: any, is drawn to from now on, and the tiles of the image are let go: asks for the rest, if it is
 * of that one. Errors as above.
 */
int readback_settle(struct readback *readback, const struct gl *gl, GLuint framebuffer, struct error *error);

/*
 * Until nothing is missing there; what was asked for before is there first, and what is left is asked for as far as
 * blocks get free. Errors as above.
 */
int readback_receive(struct readback *readback, const struct gl *gl, const struct arrival *arrival,
					 struct error *error);

/* What is under way is lost. */
void readback_forget(struct readback *readback, const struct gl *gl);

/* The same for good. */
void readback_finish(struct readback *readback, const struct gl *gl);

/* Bytes of its buffers. */
uint64_t readback_bytes(const struct readback *readback);

#endif
