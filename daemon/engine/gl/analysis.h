/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the analysis on the GPU keeps there from frame to frame. */
#ifndef PURSUIT_ENGINE_GL_ANALYSIS_H
#define PURSUIT_ENGINE_GL_ANALYSIS_H

#include <stdint.h>

#include "daemon/engine/gl/gl.h"

struct analysis {
	/* A band of motion and depth as they came, by bits: integers, so that nothing on the way looks at them. */
	struct analysis_plane {
		GLuint texture;
		GLenum internal;
		uint32_t width, height;
	} motion, depth;
	GLuint job;    /* buffer: what is asked for; what comes back takes the buffer of the warp's vertices */
	void *nothing; /* as many zero bytes as that has before the vertices, */
	size_t nothing_bytes;
};

void analysis_finish(struct analysis *analysis, const struct gl *gl);

/* Bytes of its textures and buffers. */
uint64_t analysis_bytes(const struct analysis *analysis);

#endif
