/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pictures on the GPU: 8-bit colour textures, each with a framebuffer. Row 0 is the top of the picture. */
#ifndef PURSUIT_ENGINE_GL_TARGET_H
#define PURSUIT_ENGINE_GL_TARGET_H

#include <stdint.h>

#include "daemon/engine/gl/gl.h"
#include "daemon/error.h"

struct target {
	GLuint texture, framebuffer;
	uint32_t width, height; /* 0: nothing there */
};

/* Makes it that size; what is in it is undefined afterwards if it changes. 0, or -ENOMEM with a sentence. */
int target_resize(struct target *target, const struct gl *gl, uint32_t width, uint32_t height, struct error *error);
void target_finish(struct target *target, const struct gl *gl);

uint64_t target_bytes(const struct target *target);

/* From now on draws go to the target, all of it. */
void target_draw_to(const struct target *target, const struct gl *gl);

/* Copies all pixels to a target of the same size; draws go there afterwards. */
void target_copy(const struct target *from, const struct target *to, const struct gl *gl);

#endif
