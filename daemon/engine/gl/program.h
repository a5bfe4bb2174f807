/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Shader programs: compiled when first used, kept until the engine ends. */
#ifndef PURSUIT_ENGINE_GL_PROGRAM_H
#define PURSUIT_ENGINE_GL_PROGRAM_H

#include "daemon/engine/gl/gl.h"
#include "daemon/error.h"

enum program_kind {
	PROGRAM_PYRAMID = 0,
	PROGRAM_COMPENSATE,
	PROGRAM_COPY,
	PROGRAM_WARP,
	PROGRAM_ANALYSE,
	PROGRAM_KIND_COUNT,
};

/* Variants, or-ed; each kind knows some of them. */
#define VARIANT_GAMMA 1u           /* compensate: a power law instead of sRGB */
#define VARIANT_WEIGHT_ONE 2u      /* compensate: w = 1, without geometry */
#define VARIANT_NO_COMPENSATION 4u /* compensate: the mix alone */
#define VARIANT_TEAR 8u            /* warp: fades to L where it is torn */
#define VARIANT_REAL 16u           /* compensate: E instead of B */
#define VARIANT_COUNT 32u

#define PROGRAM_UNIFORMS(X) X(size) X(shift) X(last_phase) X(level_scale) X(count) X(boost) X(gamma)

struct program {
	GLuint id; /* 0: not made yet */
#define X(name) GLint name;
	PROGRAM_UNIFORMS(X)
#undef X
};

struct program_cache {
	struct program programs[PROGRAM_KIND_COUNT][VARIANT_COUNT];
};

/* The program, in use afterwards; NULL with the compiler's words. */
const struct program *program_use(struct program_cache *cache, const struct gl *gl, enum program_kind kind,
								  unsigned variant, struct error *error);
void program_cache_finish(struct program_cache *cache, const struct gl *gl);

#endif
