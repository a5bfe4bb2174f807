/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Which triangles of the mesh need what: chunks of them side by side, their lists in drawing order all the same. */
#include "daemon/engine/warp_triangle.h"

#include <string.h>

#include "daemon/engine/pool.h"
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

enum kind {
	KIND_PLAIN = 0,
	KIND_TORN = 1,
	KIND_FOLDED = 2, /* or-ed with torn */
	KIND_HIDDEN = 4, /* turned over */
};

/* A sort under way. */
struct sort {
	struct warp_mesh *mesh;
	float phase;
	bool tears;
	uint32_t level; /* of the pyramid */
};

static struct box box_grown(struct box box, float margin)
{
	return (struct box){box.left - margin, box.top - margin, box.right + margin, box.bottom + margin};
}

/* The lists that a triangle of that kind belongs to, a bit each. */
static unsigned lists_of(const struct warp_mesh *mesh, unsigned kind)
{
	switch (kind) {
	case KIND_PLAIN:
		return 1u << WARP_PLAIN;
	case KIND_TORN:
		return 1u << WARP_TORN;
	case KIND_FOLDED:
		return 1u << WARP_FOLDED;
	case KIND_FOLDED | KIND_TORN:
		/* With the order kept these come twice: once in their place, once only to be counted. */
		return 1u << WARP_FOLDED_TORN | (mesh->keep_order ? 1u << WARP_FOLDED : 0u);
	default:
		return 0;
	}
}

static void count_lists(struct warp_mesh *mesh, uint32_t item)
{
	struct warp_share *share = &mesh->shares[item];
	uint32_t kinds[8] = {0};
	for (uint32_t i = item * TRIANGLES_OF_ITEM; i < warp_item_end(mesh, item) / 3; i++)
		kinds[mesh->kinds[i] & 7u]++;
	memset(share->at, 0, sizeof(share->at));
	for (unsigned kind = 0; kind < 8; kind++)
		for (unsigned lists = lists_of(mesh, kind), list = 0; lists >> list; list++)
			share->at[list] += lists >> list & 1u ? 3 * kinds[kind] : 0;
}

static void fill_lists(void *context, uint32_t item, uint32_t thread)
{
	struct warp_mesh *mesh = context;
	struct warp_share at = mesh->shares[item];
	for (uint32_t i = 3 * item * TRIANGLES_OF_ITEM; i < warp_item_end(mesh, item); i += 3)
		for (unsigned lists = lists_of(mesh, mesh->kinds[i / 3]), list = 0; lists >> list; list++)
			if (lists >> list & 1u) {
				memcpy(mesh->lists + at.at[list], mesh->triangles + i, 3 * sizeof(*mesh->lists));
				at.at[list] += 3;
			}
}

/* The lists from what each item has counted for them, one after another. */
static void make_lists(struct warp_mesh *mesh)
{
	struct warp_list *const lists[WARP_LISTS] = {&mesh->plain, &mesh->torn, &mesh->folded, &mesh->folded_torn};
	uint32_t at = 0;
	for (int list = 0; list < WARP_LISTS; list++) {
		lists[list]->first = at;
		for (uint32_t item = 0; item < warp_items(mesh); item++) {
			const uint32_t count = mesh->shares[item].at[list];
			mesh->shares[item].at[list] = at;
			at += count;
		}
		lists[list]->count = at - lists[list]->first;
	}
	pool_run(mesh->pool, fill_lists, mesh, warp_items(mesh));
	mesh->list_count = at;
	mesh->sorted++;
}

int warp_mesh_begin_tiles(struct warp_mesh *mesh, uint32_t width, uint32_t height, uint32_t level, struct error *error)
{
	uint32_t levels_tile = LEVELS_TILE >> level ? LEVELS_TILE : 1u << level;
	const int result = tiles_begin(&mesh->low, width, height, LOW_TILE, LOW_TILE, error);
	return result < 0 ? result : tiles_begin(&mesh->levels, width, height, levels_tile, levels_tile, error);
}

static uint8_t doubt(const struct sort *sort, const uint32_t *index)
{
	struct warp_mesh *mesh = sort->mesh;
	const struct plan_vertex *vertices = mesh->plan->vertices;
	struct map map = triangle_map(vertices, index, sort->phase);
	if (!stretches(map, 1.0f + (float)BLUR_FROM))
		return KIND_HIDDEN;
	/* Bilinear sampling reaches a pixel further; the spline 3 texels, the levels below it less than one more. */
	struct box box = triangle_box(vertices, index, 0.0f, 1.0f);
	tiles_mark(&mesh->low, box);
	tiles_mark(&mesh->levels, box_grown(box, (float)(LOW_TILE + (4u << sort->level))));
	return map.determinant > 0.0f ? KIND_TORN : KIND_HIDDEN;
}

/* Those that are not wanted are hidden. */
static void find_doubtful(void *context, uint32_t item, uint32_t thread)
{
	const struct sort *sort = context;
	struct warp_mesh *mesh = sort->mesh;
	const float phase = sort->phase;
	for (uint32_t i = 3 * item * TRIANGLES_OF_ITEM; i < warp_item_end(mesh, item); i += 3) {
		bool tame = mesh->wildness[i / 3] * phase * phase < TAME;
		mesh->kinds[i / 3] = tame ? KIND_HIDDEN : doubt(sort, mesh->triangles + i);
	}
	count_lists(mesh, item);
}

int warp_mesh_sort_doubtful(struct warp_mesh *mesh, uint32_t level, struct error *error)
{
	const struct plan *plan = mesh->plan;
	struct sort sort = {.mesh = mesh, .phase = plan->last_phase, .level = level};
	int result = warp_mesh_begin_tiles(mesh, plan->width, plan->height, level, error);
	if (result < 0)
		return result;
	pool_run(mesh->pool, find_doubtful, &sort, warp_items(mesh));
	tiles_sum(&mesh->low);
	tiles_sum(&mesh->levels);
	make_lists(mesh);
	mesh->doubtful = mesh->torn;
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

uint64_t warp_mesh_most_pixels(uint32_t width, uint32_t height)
{
	return COST_PIXELS + COST_PICTURES * (uint64_t)width * height;
}

static uint8_t kind_of(const struct sort *sort, const uint32_t *index)
{
	struct warp_mesh *mesh = sort->mesh;
	const struct plan_vertex *vertices = mesh->plan->vertices;
	struct map map = triangle_map(vertices, index, sort->phase);
	if (!(map.determinant > NEARLY_FLAT))
		tiles_mark(&mesh->folds, triangle_box(vertices, index, sort->phase, 1.0f));
	if (map.determinant < -NEARLY_FLAT)
		return KIND_HIDDEN;
	return sort->tears && stretches(map, 1.0f + (float)TEAR_FROM) ? KIND_TORN : KIND_PLAIN;
}

/* What each triangle is by itself; marks where some turn over. Stops at what costs too much. */
static void find_kinds(void *context, uint32_t item, uint32_t thread)
{
	const struct sort *sort = context;
	struct warp_mesh *mesh = sort->mesh;
	const float phase = sort->phase;
	const double most = (double)warp_mesh_most_pixels(mesh->plan->width, mesh->plan->height);
	double cost = 0.0;
	for (uint32_t i = 3 * item * TRIANGLES_OF_ITEM; i < warp_item_end(mesh, item) && cost <= most; i += 3) {
		mesh->kinds[i / 3] = KIND_PLAIN;
		if (mesh->wildness[i / 3] * phase * phase < TAME)
			continue;
		cost += triangle_cost(mesh, i, phase);
		mesh->kinds[i / 3] = kind_of(sort, mesh->triangles + i);
	}
	mesh->shares[item].cost = cost;
}

static bool is_too_wild(const struct warp_mesh *mesh)
{
	double cost = 0.0;
	for (uint32_t item = 0; item < warp_items(mesh); item++)
		cost += mesh->shares[item].cost;
	return cost > (double)warp_mesh_most_pixels(mesh->plan->width, mesh->plan->height);
}

static void find_folds(void *context, uint32_t item, uint32_t thread)
{
	const struct sort *sort = context;
	struct warp_mesh *mesh = sort->mesh;
	for (uint32_t i = 3 * item * TRIANGLES_OF_ITEM; i < warp_item_end(mesh, item) && mesh->folds.count; i += 3) {
		uint8_t *kind = &mesh->kinds[i / 3];
		struct box box = triangle_box(mesh->plan->vertices, mesh->triangles + i, sort->phase, 0.0f);
		if (*kind == KIND_HIDDEN || !tiles_touch(&mesh->folds, box))
			continue;
		*kind |= KIND_FOLDED;
	}
	count_lists(mesh, item);
}

int warp_mesh_sort(struct warp_mesh *mesh, float phase, bool tears, bool keep_order, struct error *error)
{
	const struct plan *plan = mesh->plan;
	struct sort sort = {.mesh = mesh, .phase = phase, .tears = tears};
	const int result = tiles_begin(&mesh->folds, plan->width, plan->height, FOLD_TILE, FOLD_TILE, error);
	if (result < 0)
		return result;
	mesh->keep_order = keep_order;
	pool_run(mesh->pool, find_kinds, &sort, warp_items(mesh));
	mesh->too_wild = is_too_wild(mesh);
	if (mesh->too_wild)
		return 0;
	if (mesh->test_all)
		tiles_mark_all(&mesh->folds);
	tiles_sum(&mesh->folds);
	pool_run(mesh->pool, find_folds, &sort, warp_items(mesh));
	make_lists(mesh);
	return 0;
}
