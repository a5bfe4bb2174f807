/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A GL buffer that gets new content for each frame: mapped anew, so that nobody waits for the draws that still read the
 * old content, and of one size that grows and stays, so that nothing is allocated once it is large enough.
 */
#ifndef PURSUIT_ENGINE_GL_DYNAMIC_H
#define PURSUIT_ENGINE_GL_DYNAMIC_H

#include <stddef.h>

#include "daemon/engine/gl/gl.h"
#include "daemon/error.h"

/* A zeroed one is ready for use. */
struct dynamic {
	GLuint id; /* 0 until it is first used */
	size_t bytes;
};

/* Binds it to the target, with room for so many bytes; of `most` below. What was in it is lost if that is more. */
void dynamic_reserve(struct dynamic *buffer, const struct gl *gl, GLenum target, size_t bytes, size_t most);
/*
 * Binds it to the target and gives memory for its content, to be written, not read. `most`: bytes that it can ever need
 * for pictures of that size. NULL with a sentence.
 */
void *dynamic_map(struct dynamic *buffer, const struct gl *gl, GLenum target, size_t bytes, size_t most,
				  struct error *error);
/* The content is complete. 0, or -EIO with a sentence: GL has lost it. */
int dynamic_unmap(const struct gl *gl, GLenum target, struct error *error);
void dynamic_finish(struct dynamic *buffer, const struct gl *gl);

#endif
