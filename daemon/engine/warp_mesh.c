/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/warp_mesh.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shaders/limits.h"

/* Below this squared norm of phase x gradient no triangle turns over or is stretched by more than 1.25. */
#define TAME 0.0625f
/* A triangle that shrinks to less than this share of its area may be turned over by rounding. */
#define NEARLY_FLAT 0.01f

/* A triangle costs at least what so many pixels a side do, and drawing may cost so many pixels. */
#define COST_MARGIN 8.0
#define COST_PIXELS (UINT64_C(16) << 20)
#define COST_PICTURES 16u

/* Pixels a side: of L; of the pyramid, but never less than its coarsest texel; of the displaced picture. */
#define LOW_TILE 8u
#define LEVELS_TILE 16u
#define FOLD_TILE 32u

/* Of numbers; what the library has for them is a call that looks for NaN. */
static inline float larger(float a, float b)
{
	return a > b ? a : b;
}

static inline float lesser(float a, float b)
{
	return a < b ? a : b;
}

enum kind {
	KIND_PLAIN = 0,
	KIND_TORN = 1,
	KIND_FOLDED = 2, /* or-ed with torn */
	KIND_HIDDEN = 4, /* turned over */
};

/* A triangle's map from source to displaced coordinates. */
struct map {
	float norm;        /* squared Frobenius norm: the sum of both squared singular values */
	float determinant; /* their product, negative if it turns over */
};

/* The displacement's gradient within a triangle. */
struct gradient {
	float xx, xy, yx, yy;
};

static struct gradient triangle_gradient(const struct plan_vertex *vertices, const uint32_t *index)
{
	const struct plan_vertex *a = &vertices[index[0]], *b = &vertices[index[1]], *c = &vertices[index[2]];
	float bx = b->x - a->x, by = b->y - a->y, cx = c->x - a->x, cy = c->y - a->y;
	float bu = b->ux - a->ux, bv = b->uy - a->uy, cu = c->ux - a->ux, cv = c->uy - a->uy;
	float scale = 1.0f / (bx * cy - cx * by);
	return (struct gradient){(bu * cy - cu * by) * scale, (cu * bx - bu * cx) * scale, (bv * cy - cv * by) * scale,
							 (cv * bx - bv * cx) * scale};
}

static struct map triangle_map(const struct plan_vertex *vertices, const uint32_t *index, float phase)
{
	struct gradient g = triangle_gradient(vertices, index);
	float xx = 1.0f + phase * g.xx, xy = phase * g.xy, yx = phase * g.yx, yy = 1.0f + phase * g.yy;
	return (struct map){xx * xx + xy * xy + yx * yx + yy * yy, xx * yy - xy * yx};
}

/* Whether the larger singular value is above the limit; true for degenerate triangles. */
static bool stretches(struct map map, float limit)
{
	float squared = limit * limit;
	bool below = map.norm <= 2.0f * squared &&
				 squared * squared - squared * map.norm + map.determinant * map.determinant >= 0.0f;
	return !below;
}

static struct box triangle_box(const struct plan_vertex *vertices, const uint32_t *index, float phase, float margin)
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

static struct box box_grown(struct box box, float margin)
{
	return (struct box){box.left - margin, box.top - margin, box.right + margin, box.bottom + margin};
}

static bool reserve(struct warp_mesh *mesh, uint32_t count)
{
	if (count <= mesh->capacity)
		return true;
	mesh->capacity = 0;
	free(mesh->triangles);
	free(mesh->lists);
	free(mesh->wildness);
	free(mesh->kinds);
	mesh->triangles = malloc((size_t)count * sizeof(*mesh->triangles));
	mesh->lists = malloc(2 * (size_t)count * sizeof(*mesh->lists));
	mesh->wildness = malloc((size_t)count / 3 * sizeof(*mesh->wildness));
	mesh->kinds = malloc((size_t)count / 3);
	if (!mesh->triangles || !mesh->lists || !mesh->wildness || !mesh->kinds)
		return false;
	mesh->capacity = count;
	return true;
}

static void measure_triangles(struct warp_mesh *mesh)
{
	for (uint32_t i = 0; i < mesh->count; i += 3) {
		struct gradient g = triangle_gradient(mesh->plan->vertices, mesh->triangles + i);
		mesh->wildness[i / 3] = g.xx * g.xx + g.xy * g.xy + g.yx * g.yx + g.yy * g.yy;
	}
}

int warp_mesh_begin(struct warp_mesh *mesh, const struct plan *plan, float tolerance, struct error *error)
{
	mesh->plan = plan;
	if (!reserve(mesh, plan->index_count))
		return error_set(error, -ENOMEM, "out of memory for %u triangles", plan->index_count / 3);
	mesh->count = plan->index_count;
	mesh->tolerance = tolerance > 0.0f ? tolerance : 0.0f;
	if (tolerance >= 0.0f)
		mesh->count = merge_triangles(&mesh->merge, plan, tolerance, mesh->triangles);
	else
		memcpy(mesh->triangles, plan->indices, plan->index_count * sizeof(*plan->indices));
	if (!mesh->count)
		return error_set(error, -ENOMEM, "out of memory for %u cells", plan->index_count / 6);
	measure_triangles(mesh);
	mesh->begun++;
	return 0;
}

/* Appends the triangles of some kinds to the lists. */
static struct warp_list collect(struct warp_mesh *mesh, uint32_t first, unsigned mask, unsigned kind)
{
	struct warp_list list = {first, 0};
	uint32_t *to = mesh->lists + first;
	for (uint32_t i = 0; i < mesh->count; i += 3)
		if ((mesh->kinds[i / 3] & mask) == kind) {
			memcpy(to + list.count, mesh->triangles + i, 3 * sizeof(*to));
			list.count += 3;
		}
	return list;
}

static uint32_t end_of(struct warp_list list)
{
	return list.first + list.count;
}

/* The lists are complete: they end with this one. */
static void close_lists(struct warp_mesh *mesh, struct warp_list last)
{
	mesh->list_count = end_of(last);
	mesh->sorted++;
}

int warp_mesh_begin_tiles(struct warp_mesh *mesh, uint32_t width, uint32_t height, uint32_t level, struct error *error)
{
	uint32_t levels_tile = LEVELS_TILE >> level ? LEVELS_TILE : 1u << level;
	if (tiles_begin(&mesh->low, width, height, LOW_TILE) && tiles_begin(&mesh->levels, width, height, levels_tile))
		return 0;
	return error_set(error, -ENOMEM, "out of memory for the tiles of %u x %u pixels", width, height);
}

int warp_mesh_sort_doubtful(struct warp_mesh *mesh, uint32_t level, struct error *error)
{
	const struct plan *plan = mesh->plan;
	float phase = plan->last_phase;
	int result = warp_mesh_begin_tiles(mesh, plan->width, plan->height, level, error);
	if (result < 0)
		return result;
	for (uint32_t i = 0; i < mesh->count; i += 3) {
		mesh->kinds[i / 3] = KIND_PLAIN;
		if (mesh->wildness[i / 3] * phase * phase < TAME)
			continue;
		struct map map = triangle_map(plan->vertices, mesh->triangles + i, phase);
		if (!stretches(map, 1.0f + (float)BLUR_FROM))
			continue;
		/* Bilinear sampling reaches a pixel further; the spline 3 texels, the levels below it less than one more. */
		struct box box = triangle_box(plan->vertices, mesh->triangles + i, 0.0f, 1.0f);
		tiles_mark(&mesh->low, box);
		tiles_mark(&mesh->levels, box_grown(box, (float)(LOW_TILE + (4u << level))));
		mesh->kinds[i / 3] = map.determinant > 0.0f ? KIND_TORN : KIND_HIDDEN;
	}
	mesh->doubtful = collect(mesh, 0, KIND_TORN | KIND_HIDDEN, KIND_TORN);
	close_lists(mesh, mesh->doubtful);
	return 0;
}

/* Length of an interval within 0 to size, with what a triangle costs however small it is. */
static double cost_along(float from, float to, uint32_t size)
{
	from = larger(from, 0.0f);
	to = lesser(to, (float)size);
	return (to > from ? (double)(to - from) : 0.0) + COST_MARGIN;
}

/* Pixels that drawing a triangle may touch. */
static double triangle_cost(const struct warp_mesh *mesh, uint32_t i, float phase)
{
	struct box box = triangle_box(mesh->plan->vertices, mesh->triangles + i, phase, 0.0f);
	return cost_along(box.left, box.right, mesh->plan->width) * cost_along(box.top, box.bottom, mesh->plan->height);
}

/* What each triangle is by itself; marks where some turn over. Stops at what costs too much. */
static void find_kinds(struct warp_mesh *mesh, float phase, bool tears)
{
	const struct plan_vertex *vertices = mesh->plan->vertices;
	const double most = (double)warp_mesh_most_pixels(mesh->plan->width, mesh->plan->height);
	double cost = 0.0;
	for (uint32_t i = 0; i < mesh->count && cost <= most; i += 3) {
		mesh->kinds[i / 3] = KIND_PLAIN;
		if (mesh->wildness[i / 3] * phase * phase < TAME)
			continue;
		cost += triangle_cost(mesh, i, phase);
		struct map map = triangle_map(vertices, mesh->triangles + i, phase);
		if (tears && stretches(map, 1.0f + (float)TEAR_FROM))
			mesh->kinds[i / 3] = KIND_TORN;
		if (!(map.determinant > NEARLY_FLAT))
			tiles_mark(&mesh->folds, triangle_box(vertices, mesh->triangles + i, phase, 1.0f));
		if (map.determinant < -NEARLY_FLAT)
			mesh->kinds[i / 3] = KIND_HIDDEN;
	}
	mesh->too_wild = cost > most;
}

static void find_folds(struct warp_mesh *mesh, float phase)
{
	for (uint32_t i = 0; i < mesh->count; i += 3) {
		uint8_t *kind = &mesh->kinds[i / 3];
		struct box box = triangle_box(mesh->plan->vertices, mesh->triangles + i, phase, 0.0f);
		if (*kind == KIND_HIDDEN || !tiles_touch(&mesh->folds, box))
			continue;
		*kind |= KIND_FOLDED;
	}
}

uint64_t warp_mesh_most_pixels(uint32_t width, uint32_t height)
{
	return COST_PIXELS + COST_PICTURES * (uint64_t)width * height;
}

int warp_mesh_sort(struct warp_mesh *mesh, float phase, bool tears, bool keep_order, struct error *error)
{
	const struct plan *plan = mesh->plan;
	if (!tiles_begin(&mesh->folds, plan->width, plan->height, FOLD_TILE))
		return error_set(error, -ENOMEM, "out of memory for the tiles of %u x %u pixels", plan->width, plan->height);
	find_kinds(mesh, phase, tears);
	if (mesh->too_wild)
		return 0;
	if (mesh->folds.count)
		find_folds(mesh, phase);
	const unsigned all = KIND_TORN | KIND_FOLDED | KIND_HIDDEN;
	mesh->keep_order = keep_order;
	mesh->plain = collect(mesh, 0, all, KIND_PLAIN);
	mesh->torn = collect(mesh, end_of(mesh->plain), all, KIND_TORN);
	mesh->folded = collect(mesh, end_of(mesh->torn), keep_order ? KIND_FOLDED : all, KIND_FOLDED);
	/* With the order kept these come twice: once in their place, once only to be counted. */
	mesh->folded_torn = collect(mesh, end_of(mesh->folded), all, KIND_FOLDED | KIND_TORN);
	close_lists(mesh, mesh->folded_torn);
	return 0;
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
