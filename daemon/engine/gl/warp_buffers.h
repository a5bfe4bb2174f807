/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The warp mesh in GL buffers, which are orphaned and refilled when it has changed. */
#ifndef PURSUIT_ENGINE_GL_WARP_BUFFERS_H
#define PURSUIT_ENGINE_GL_WARP_BUFFERS_H

#include "daemon/engine/gl/gl.h"
#include "daemon/engine/warp_mesh.h"

struct warp_buffers {
	GLuint array, vertices, indices;
	uint64_t begun, sorted; /* what they hold, as the mesh counts */
};

/* Makes them hold the mesh; returns how many bytes were sent. */
uint64_t warp_buffers_update(struct warp_buffers *buffers, const struct gl *gl, const struct warp_mesh *mesh);
void warp_buffers_finish(struct warp_buffers *buffers, const struct gl *gl);

/* Draws a list of the mesh that the buffers hold. */
void warp_buffers_draw(const struct warp_buffers *buffers, const struct gl *gl, struct warp_list list);

#endif
