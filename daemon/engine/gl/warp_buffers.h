/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The warp mesh in GL buffers, refilled when it has changed. */
#ifndef PURSUIT_ENGINE_GL_WARP_BUFFERS_H
#define PURSUIT_ENGINE_GL_WARP_BUFFERS_H

#include "daemon/engine/gl/dynamic.h"
#include "daemon/engine/warp_mesh.h"

struct warp_buffers {
	GLuint array;
	struct dynamic vertices, indices;
	uint64_t begun, sorted; /* what they hold, as the mesh counts */
	struct warp_list plain; /* of mesh->plain what is to be drawn */
	bool split;             /* that is not all of it */
};

/*
 * Makes them hold the mesh; adds to *sent how many bytes that took. `moving`: NULL, or where it has to be drawn:
 * triangles of mesh->plain that rest are left out elsewhere, and what they touch is marked in `touched` (of the same
 * tiles) where they are not. 0, or a negative errno with a sentence.
 */
int warp_buffers_update(struct warp_buffers *buffers, const struct gl *gl, const struct warp_mesh *mesh,
						const struct tiles *moving, struct tiles *touched, uint64_t *sent, struct error *error);
void warp_buffers_finish(struct warp_buffers *buffers, const struct gl *gl);

/* A list of the mesh as it was once, to be drawn when the mesh has been sorted, and perhaps displaced, anew. */
struct warp_kept {
	GLuint array;
	struct dynamic displacements, indices;
	GLsizei count;
};

/*
 * Keeps the list, which draws with the vertices in `buffers`. These must be of the same frame still when it is drawn;
 * `bends`: by then they may have other displacements, so that those of now are kept. Adds to *sent how many bytes that
 * took. 0, or a negative errno with a sentence.
 */
int warp_kept_update(struct warp_kept *kept, struct warp_buffers *buffers, const struct gl *gl,
					 const struct warp_mesh *mesh, struct warp_list list, bool bends, uint64_t *sent,
					 struct error *error);
void warp_kept_draw(const struct warp_kept *kept, const struct gl *gl);
void warp_kept_finish(struct warp_kept *kept, const struct gl *gl);

/* Draws a list of the mesh that the buffers hold. */
void warp_buffers_draw(const struct warp_buffers *buffers, const struct gl *gl, struct warp_list list);

#endif
