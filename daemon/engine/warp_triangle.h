/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the mesh knows of one triangle, for those who sort and draw it. */
#ifndef PURSUIT_ENGINE_WARP_TRIANGLE_H
#define PURSUIT_ENGINE_WARP_TRIANGLE_H

#include <math.h>

#include "daemon/engine/warp_mesh.h"

/* Triangles that a thread takes at a time. */
#define TRIANGLES_OF_ITEM 1024u

static inline uint32_t warp_items(const struct warp_mesh *mesh)
{
	return (mesh->count / 3 + TRIANGLES_OF_ITEM - 1) / TRIANGLES_OF_ITEM;
}

/* Where the triangles of an item end; index of an index. */
static inline uint32_t warp_item_end(const struct warp_mesh *mesh, uint32_t item)
{
	const uint32_t end = 3 * (item + 1) * TRIANGLES_OF_ITEM;
	return end < mesh->count ? end : mesh->count;
}

/* Of numbers; what the library has for them is a call that looks for NaN. */
static inline float larger(float a, float b)
{
	return a > b ? a : b;
}

static inline float lesser(float a, float b)
{
	return a < b ? a : b;
}

/* A triangle's map from source to displaced coordinates. */
struct map {
	float norm;        /* squared Frobenius norm: the sum of both squared singular values */
	float determinant; /* their product, negative if it turns over */
};

/* The displacement's gradient within a triangle. */
struct gradient {
	float xx, xy, yx, yy;
};

static inline struct gradient triangle_gradient(const struct plan_vertex *vertices, const uint32_t *index)
{
	const struct plan_vertex *a = &vertices[index[0]], *b = &vertices[index[1]], *c = &vertices[index[2]];
	float bx = b->x - a->x, by = b->y - a->y, cx = c->x - a->x, cy = c->y - a->y;
	float bu = b->ux - a->ux, bv = b->uy - a->uy, cu = c->ux - a->ux, cv = c->uy - a->uy;
	float scale = 1.0f / (bx * cy - cx * by);
	return (struct gradient){(bu * cy - cu * by) * scale, (cu * bx - bu * cx) * scale, (bv * cy - cv * by) * scale,
							 (cv * bx - bv * cx) * scale};
}

static inline struct map triangle_map(const struct plan_vertex *vertices, const uint32_t *index, float phase)
{
	struct gradient g = triangle_gradient(vertices, index);
	float xx = 1.0f + phase * g.xx, xy = phase * g.xy, yx = phase * g.yx, yy = 1.0f + phase * g.yy;
	return (struct map){xx * xx + xy * xy + yx * yx + yy * yy, xx * yy - xy * yx};
}

/* Whether the larger singular value is above the limit; true for degenerate triangles. */
static inline bool stretches(struct map map, float limit)
{
	float squared = limit * limit;
	bool below = map.norm <= 2.0f * squared &&
				 squared * squared - squared * map.norm + map.determinant * map.determinant >= 0.0f;
	return !below;
}

static inline bool warp_triangle_rests(const struct warp_mesh *mesh, const uint32_t *index)
{
	const struct plan_vertex *vertices = mesh->plan->vertices;
	for (int i = 0; i < 3; i++)
		if (vertices[index[i]].ux != 0.0f || vertices[index[i]].uy != 0.0f)
			return false;
	return true;
}

static inline struct box triangle_box(const struct plan_vertex *vertices, const uint32_t *index, float phase,
									  float margin)
{
	struct box box = {INFINITY, INFINITY, -INFINITY, -INFINITY};
	for (int i = 0; i < 3; i++) {
		const struct plan_vertex *vertex = &vertices[index[i]];
		float x = vertex->x + phase * vertex->ux, y = vertex->y + phase * vertex->uy;
		box.left = lesser(box.left, x - margin);
		box.right = larger(box.right, x + margin);
		box.top = lesser(box.top, y - margin);
		box.bottom = larger(box.bottom, y + margin);
	}
	return box;
}

#endif
