/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Pixels on their way back from the framebuffer that is bound for reading, rows as they lie. On a GPU block by block
 * through GL buffers that take turns: it fills the next ones while one is copied to where it belongs. A CPU renderer
 * writes there itself.
 */
#ifndef PURSUIT_ENGINE_GL_READBACK_H
#define PURSUIT_ENGINE_GL_READBACK_H

#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/gl/gl.h"
#include "daemon/error.h"

#define READBACK_BLOCKS 4u

struct readback {
	bool buffered; /* by GL buffers */
	struct readback_block {
		GLuint buffer;
		size_t bytes;
		GLsync filled; /* NULL: nothing under way */
	} blocks[READBACK_BLOCKS];
};

struct readback_image {
	uint8_t *data;
	size_t stride; /* bytes, a multiple of 4 */
	uint32_t width, height;
};

/* Returns when all pixels are there. 0, or a negative errno with a sentence (-EIO: the context is lost, -ENOMEM). */
int readback_run(struct readback *readback, const struct gl *gl, const struct readback_image *image,
				 struct error *error);
void readback_finish(struct readback *readback, const struct gl *gl);

/* Bytes of its buffers. */
uint64_t readback_bytes(const struct readback *readback);

#endif
