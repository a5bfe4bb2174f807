/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/warp_mesh.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/pool.h"
#include "daemon/engine/warp_triangle.h"
#include "shaders/limits.h"

/* Triangles of a plan below which waking threads takes longer than what they would do. */
#define LEAST_SHARED 32768u

/* Indices; `most` that there can be. */
static bool reserve(struct warp_mesh *mesh, uint32_t count, uint32_t most)
{
	if (count <= mesh->capacity)
		return true;
	mesh->capacity = 0;
	/* Room to grow, so that it soon does not any more. */
	count += count / 6 * 3;
	count = count < most ? count : most;
	free(mesh->triangles);
	free(mesh->lists);
	free(mesh->wildness);
	free(mesh->kinds);
	free(mesh->shares);
	mesh->triangles = malloc((size_t)count * sizeof(*mesh->triangles));
	mesh->lists = malloc(2 * (size_t)count * sizeof(*mesh->lists));
	mesh->wildness = malloc((size_t)count / 3 * sizeof(*mesh->wildness));
	mesh->kinds = malloc((size_t)count / 3);
	mesh->shares = malloc((count / 3 / TRIANGLES_OF_ITEM + 1) * sizeof(*mesh->shares));
	if (!mesh->triangles || !mesh->lists || !mesh->wildness || !mesh->kinds || !mesh->shares)
		return false;
	mesh->capacity = count;
	return true;
}

static void measure(void *context, uint32_t item, uint32_t thread)
{
	struct warp_mesh *mesh = context;
	for (uint32_t i = 3 * item * TRIANGLES_OF_ITEM; i < warp_item_end(mesh, item); i += 3) {
		struct gradient g = triangle_gradient(mesh->plan->vertices, mesh->triangles + i);
		mesh->wildness[i / 3] = g.xx * g.xx + g.xy * g.xy + g.yx * g.yx + g.yy * g.yy;
	}
}

int warp_mesh_begin(struct warp_mesh *mesh, const struct plan *plan, float tolerance, struct pool *pool,
					struct error *error)
{
	mesh->plan = plan;
	mesh->pool = plan->index_count / 3 >= LEAST_SHARED ? pool : NULL;
	mesh->tolerance = tolerance > 0.0f ? tolerance : 0.0f;
	mesh->count = 0;
	const uint32_t count = tolerance < 0.0f ? plan->index_count : merge_find(&mesh->merge, plan, tolerance, mesh->pool);
	if (!count)
		return error_set(error, -ENOMEM, "out of memory for %u cells", plan->index_count / 6);
	if (!reserve(mesh, count, plan->index_count))
		return error_set(error, -ENOMEM, "out of memory for %u triangles", count / 3);
	mesh->count = count;
	if (tolerance < 0.0f)
		memcpy(mesh->triangles, plan->indices, plan->index_count * sizeof(*plan->indices));
	else
		merge_write(&mesh->merge, plan, mesh->pool, mesh->triangles);
	pool_run(mesh->pool, measure, mesh, warp_items(mesh));
	mesh->begun++;
	return 0;
}

uint64_t warp_mesh_bytes(const struct warp_mesh *mesh)
{
	const uint64_t of_triangle = 9 * sizeof(uint32_t) + sizeof(*mesh->wildness) + sizeof(*mesh->kinds);
	const uint64_t of_vertex = sizeof(*mesh->merge.leaves) + sizeof(*mesh->merge.used) + sizeof(*mesh->merge.flat) +
							   sizeof(*mesh->merge.depths);
	return of_triangle * (mesh->capacity / 3) + of_vertex * mesh->merge.capacity + mesh->folds.capacity +
		   mesh->low.capacity + mesh->levels.capacity;
}

void warp_mesh_finish(struct warp_mesh *mesh)
{
	merge_finish(&mesh->merge);
	tiles_finish(&mesh->folds);
	tiles_finish(&mesh->low);
	tiles_finish(&mesh->levels);
	free(mesh->triangles);
	free(mesh->lists);
	free(mesh->wildness);
	free(mesh->kinds);
	free(mesh->shares);
	*mesh = (struct warp_mesh){0};
}

/* The larger singular value of the map from source to displaced triangle. */
static double stretch_of(const struct warp_mesh *mesh, const uint32_t *index, double phase)
{
	const struct plan_vertex *v = mesh->plan->vertices;
	const struct plan_vertex *a = &v[index[0]], *b = &v[index[1]], *c = &v[index[2]];
	double bx = (double)b->x - (double)a->x, by = (double)b->y - (double)a->y;
	double cx = (double)c->x - (double)a->x, cy = (double)c->y - (double)a->y;
	double bu = phase * ((double)b->ux - (double)a->ux), bv = phase * ((double)b->uy - (double)a->uy);
	double cu = phase * ((double)c->ux - (double)a->ux), cv = phase * ((double)c->uy - (double)a->uy);
	double scale = 1.0 / (bx * cy - cx * by);
	double xx = 1.0 + (bu * cy - cu * by) * scale, xy = (cu * bx - bu * cx) * scale;
	double yx = (bv * cy - cv * by) * scale, yy = 1.0 + (cv * bx - bv * cx) * scale;
	double first = xx * xx + yx * yx, second = xy * xy + yy * yy, both = xx * xy + yx * yy;
	double spread = sqrt((first - second) * (first - second) + 4.0 * both * both);
	return sqrt(0.5 * (first + second + spread));
}

static double smoothstep(double from, double to, double x)
{
	double t = (x - from) / (to - from);
	t = t > 0.0 ? t < 1.0 ? t : 1.0 : 0.0;
	return t * t * (3.0 - 2.0 * t);
}

double warp_mesh_weight(const struct warp_mesh *mesh, const uint32_t *index, float phase)
{
	return smoothstep(BLUR_FROM, BLUR_FULL, stretch_of(mesh, index, (double)phase) - 1.0);
}

double warp_mesh_tear(const struct warp_mesh *mesh, const uint32_t *index, float phase)
{
	return smoothstep(TEAR_FROM, TEAR_FULL, stretch_of(mesh, index, (double)phase) - 1.0);
}
