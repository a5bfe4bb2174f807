/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The plan's grid as GL buffers: its vertices and three lists of triangles.
 * Buffers are orphaned and refilled, memory grows and stays.
 */
#ifndef PURSUIT_ENGINE_WARP_MESH_H
#define PURSUIT_ENGINE_WARP_MESH_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/engine/gl.h"
#include "daemon/engine/plan.h"
#include "daemon/error.h"

struct warp_mesh {
	GLuint array, vertices, indices;
	/* Ranges of the index buffer; indices, not triangles. */
	uint32_t whole_first, whole_count;       /* never torn between phases 0 and last_phase */
	uint32_t torn_first, torn_count;         /* possibly torn there */
	uint32_t doubtful_first, doubtful_count; /* with a blur weight */
	uint32_t ordered_first, ordered_count;   /* all of them, in drawing order; there only if `ordered` */
	bool ordered;                            /* then whole and torn ones are not in the buffer */
	uint64_t bytes;                          /* sent by the last upload */
	uint32_t *lists;                         /* whole, torn and doubtful on the CPU */
	uint32_t capacity;
};

/* Sorts the triangles and fills the buffers. 0 or -ENOMEM with a sentence. */
int warp_mesh_upload(struct warp_mesh *mesh, const struct gl *gl, const struct plan *plan, bool ordered, struct error *error);
/* Whether any triangle is stretched so far at a phase that it tears. */
bool warp_mesh_tears(const struct plan *plan, float phase);
void warp_mesh_finish(struct warp_mesh *mesh, const struct gl *gl);

/* Draws a list that was uploaded: what part of the picture it covers is the caller's business. */
void warp_mesh_draw_whole(const struct warp_mesh *mesh, const struct gl *gl);
void warp_mesh_draw_torn(const struct warp_mesh *mesh, const struct gl *gl);
void warp_mesh_draw_ordered(const struct warp_mesh *mesh, const struct gl *gl);
void warp_mesh_draw_doubtful(const struct warp_mesh *mesh, const struct gl *gl);

#endif
