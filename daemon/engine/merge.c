/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/merge.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/pool.h"

#define LARGEST 8u
/* Pixels by which cells may differ in size, and depth that a vertex may be off: both far below what shows. */
#define POSITION_TOLERANCE 1e-3f
#define DEPTH_TOLERANCE 2e-4f

/* Of numbers; what the library has for them is a call that looks for NaN. */
static inline float larger(float a, float b)
{
	return a > b ? a : b;
}

static inline float lesser(float a, float b)
{
	return a < b ? a : b;
}

/* A block's corners and the way it is split. */
struct block {
	const struct plan_vertex *v00, *v10, *v01, *v11;
	bool falling; /* along v00 v11 */
};

struct tolerance {
	float displacement, depth;
};

/* Pictures have at most 16384 pixels a side. */
static struct merge_leaf leaf_at(uint32_t column, uint32_t row, uint32_t size)
{
	return (struct merge_leaf){(uint16_t)column, (uint16_t)row, (uint16_t)size};
}

static struct block block_at(const struct plan *plan, const struct merge_leaf *leaf)
{
	const struct plan_vertex *top = plan->vertices + (size_t)leaf->row * plan->columns + leaf->column;
	const struct plan_vertex *bottom = top + (size_t)leaf->size * plan->columns;
	struct block block = {top, top + leaf->size, bottom, bottom + leaf->size, false};
	float fx = block.v00->ux - block.v11->ux, fy = block.v00->uy - block.v11->uy;
	float rx = block.v10->ux - block.v01->ux, ry = block.v10->uy - block.v01->uy;
	/* The rule of the plan: the diagonal whose ends move more alike. */
	block.falling = fx * fx + fy * fy <= rx * rx + ry * ry;
	return block;
}

/* Whether the two triangles pass by a vertex at (s, t) within the block, each 0 to 1. */
static bool passes_by(const struct block *block, const struct plan_vertex *vertex, float s, float t,
					  const struct tolerance *tolerance)
{
	float w00, w10, w01, w11;
	if (block->falling) {
		w00 = 1.0f - larger(s, t);
		w11 = lesser(s, t);
		w10 = larger(s - t, 0.0f);
		w01 = larger(t - s, 0.0f);
	} else {
		w00 = larger(1.0f - s - t, 0.0f);
		w11 = larger(s + t - 1.0f, 0.0f);
		w10 = s - w11;
		w01 = t - w11;
	}
	const struct plan_vertex *a = block->v00, *b = block->v10, *c = block->v01, *d = block->v11;
	float x = w00 * a->x + w10 * b->x + w01 * c->x + w11 * d->x - vertex->x;
	float y = w00 * a->y + w10 * b->y + w01 * c->y + w11 * d->y - vertex->y;
	float ux = w00 * a->ux + w10 * b->ux + w01 * c->ux + w11 * d->ux - vertex->ux;
	float uy = w00 * a->uy + w10 * b->uy + w01 * c->uy + w11 * d->uy - vertex->uy;
	float z = w00 * a->z + w10 * b->z + w01 * c->z + w11 * d->z - vertex->z;
	return larger(fabsf(x), fabsf(y)) <= POSITION_TOLERANCE &&
		   larger(fabsf(ux), fabsf(uy)) <= tolerance->displacement && fabsf(z) <= tolerance->depth;
}

static bool is_flat(const struct plan *plan, const struct merge_leaf *leaf, const struct tolerance *tolerance)
{
	struct block block = block_at(plan, leaf);
	float step = 1.0f / (float)leaf->size;
	for (uint32_t j = 0; j <= leaf->size; j++)
		for (uint32_t i = 0; i <= leaf->size; i++) {
			const struct plan_vertex *vertex = block.v00 + (size_t)j * plan->columns + i;
			if (vertex->snapped != 0.0f || !passes_by(&block, vertex, (float)i * step, (float)j * step, tolerance))
				return false;
		}
	return true;
}

/* Neither moves nor is snapped any vertex of the block: they lie where they always do. */
static bool rests(const struct plan *plan, const struct merge_leaf *leaf)
{
	const struct plan_vertex *row = plan->vertices + (size_t)leaf->row * plan->columns + leaf->column;
	for (uint32_t j = 0; j <= leaf->size; j++, row += plan->columns)
		for (uint32_t i = 0; i <= leaf->size; i++)
			if (row[i].ux != 0.0f || row[i].uy != 0.0f || row[i].snapped != 0.0f)
				return false;
	return true;
}

/* A merge under way. */
struct work {
	struct merge *merge;
	const struct plan *plan;
	struct tolerance tolerance;
	bool depths; /* they matter */
	uint32_t *indices;
};

/* Rows of blocks: the outermost row of cells, then eights of them. */
static uint32_t first_row(uint32_t block_row)
{
	return block_row ? 1 + (block_row - 1) * LARGEST : 0;
}

static struct merge_leaf *leaves_of(const struct work *work, uint32_t block_row)
{
	return work->merge->leaves + (size_t)first_row(block_row) * (work->plan->columns - 1);
}

/* Rows of blocks share the vertices between them. */
static void use(uint8_t *vertex)
{
	__atomic_store_n(vertex, 1, __ATOMIC_RELAXED);
}

static void add_leaf(const struct work *work, uint32_t block_row, struct merge_leaf leaf)
{
	uint8_t *top = work->merge->used + (size_t)leaf.row * work->plan->columns + leaf.column;
	uint8_t *bottom = top + (size_t)leaf.size * work->plan->columns;
	use(top);
	use(top + leaf.size);
	use(bottom);
	use(bottom + leaf.size);
	leaves_of(work, block_row)[work->merge->rows[block_row].leaves++] = leaf;
}

/* What is found out of a block at rest holds until its depths change, or for ever if these do not matter. */
static bool may_merge(const struct work *work, const struct merge_leaf *leaf)
{
	uint8_t *known = work->merge->flat + (size_t)leaf->row * work->plan->columns + leaf->column;
	const unsigned bit = work->depths ? MERGE_FLAT_DEPTHS(leaf->size) : MERGE_FLAT(leaf->size);
	const bool lasts = rests(work->plan, leaf);
	if (lasts && *known & bit)
		return true;
	const bool flat = is_flat(work->plan, leaf, &work->tolerance);
	if (lasts && flat)
		*known |= (uint8_t)bit;
	return flat;
}

/* Forgets what depends on the depths of a block of the largest size, part of which may lie beyond the plan. */
static void compare_depths(const struct work *work, uint32_t column, uint32_t row)
{
	const struct plan *plan = work->plan;
	const uint32_t right = column + LARGEST < plan->columns ? column + LARGEST : plan->columns - 1;
	const uint32_t bottom = row + LARGEST < plan->rows ? row + LARGEST : plan->rows - 1;
	bool same = true;
	for (uint32_t j = row; j <= bottom && same; j++)
		for (uint32_t i = column; i <= right; i++) {
			const size_t at = (size_t)j * plan->columns + i;
			same &= plan->vertices[at].z == work->merge->depths[at];
		}
	for (uint32_t j = row; j < bottom && !same; j++)
		for (uint32_t i = column; i < right; i++)
			work->merge->flat[(size_t)j * plan->columns + i] &= MERGE_FLAT_DEPTHS(1) - 1;
}

/* Of the rows of vertices above those of the next row of blocks. */
static void keep_depths(const struct work *work, uint32_t block_row)
{
	const struct plan *plan = work->plan;
	const uint32_t next = first_row(block_row + 1), end = next + 1 < plan->rows ? next : plan->rows;
	for (size_t at = (size_t)first_row(block_row) * plan->columns; at < (size_t)end * plan->columns; at++)
		work->merge->depths[at] = plan->vertices[at].z;
}

static void divide(const struct work *work, uint32_t block_row, struct merge_leaf leaf)
{
	uint32_t columns = work->plan->columns - 1, rows = work->plan->rows - 1;
	if (leaf.column >= columns || leaf.row >= rows)
		return;
	bool inside = leaf.column + leaf.size <= columns && leaf.row + leaf.size <= rows;
	if (leaf.size == 1 || (inside && may_merge(work, &leaf))) {
		add_leaf(work, block_row, leaf);
		return;
	}
	uint32_t half = leaf.size / 2;
	for (uint32_t i = 0; i < 4; i++)
		divide(work, block_row, leaf_at(leaf.column + (i & 1) * half, leaf.row + (i >> 1) * half, half));
}

/* The outermost row and column of cells are halves; blocks begin at the first whole cell. */
static void divide_row(void *context, uint32_t block_row, uint32_t thread)
{
	const struct work *work = context;
	const struct plan *plan = work->plan;
	const uint32_t row = first_row(block_row);
	work->merge->rows[block_row].leaves = 0;
	if (block_row == 0) {
		for (uint32_t i = 0; i + 1 < plan->columns; i++)
			add_leaf(work, 0, leaf_at(i, 0, 1));
		return;
	}
	for (uint32_t i = row; i < row + LARGEST && i + 1 < plan->rows; i++)
		add_leaf(work, block_row, leaf_at(0, i, 1));
	for (uint32_t column = 1; column + 1 < plan->columns; column += LARGEST) {
		if (work->depths)
			compare_depths(work, column, row);
		divide(work, block_row, leaf_at(column, row, LARGEST));
	}
}

static bool reserve(struct merge *merge, const struct plan *plan)
{
	uint32_t vertices = plan->columns * plan->rows;
	if (vertices > merge->capacity) {
		merge_finish(merge);
		merge->used = malloc(vertices);
		merge->flat = calloc(vertices, 1);
		merge->depths = calloc(vertices, sizeof(*merge->depths));
		merge->leaves = malloc(vertices * sizeof(*merge->leaves));
		/* At most as many as vertices: there are at least two in a row. */
		merge->rows = malloc((vertices / (2 * LARGEST) + 2) * sizeof(*merge->rows));
		if (!merge->used || !merge->flat || !merge->depths || !merge->leaves || !merge->rows)
			return false;
		merge->capacity = vertices;
	}
	if (merge->width != plan->width || merge->height != plan->height || merge->cell != plan->cell)
		memset(merge->flat, 0, vertices);
	merge->width = plan->width;
	merge->height = plan->height;
	merge->cell = plan->cell;
	memset(merge->used, 0, vertices);
	return true;
}

/* The used vertices around a leaf, from its first corner on, turning the positive way. */
static uint32_t walk_around(const struct merge *merge, const struct plan *plan, const struct merge_leaf *leaf,
							uint32_t around[4 * LARGEST])
{
	uint32_t at = leaf->row * plan->columns + leaf->column, count = 0;
	const uint32_t steps[4] = {1, plan->columns, UINT32_MAX, 0u - plan->columns};
	for (int side = 0; side < 4; side++)
		for (uint32_t i = 0; i < leaf->size; i++, at += steps[side])
			if (merge->used[at])
				around[count++] = at;
	return count;
}

static uint32_t put(uint32_t *indices, uint32_t a, uint32_t b, uint32_t c)
{
	indices[0] = a;
	indices[1] = b;
	indices[2] = c;
	return 3;
}

static uint32_t emit(const struct merge *merge, const struct plan *plan, const struct merge_leaf *leaf,
					 uint32_t *indices)
{
	if (leaf->size == 1) {
		memcpy(indices, plan->indices + 6 * ((size_t)leaf->row * (plan->columns - 1) + leaf->column),
			   6 * sizeof(*indices));
		return 6;
	}
	uint32_t around[4 * LARGEST], used = 0, count = walk_around(merge, plan, leaf, around);
	if (count == 4) {
		/* around: v00 v10 v11 v01 */
		bool falling = block_at(plan, leaf).falling;
		used = put(indices, around[0], around[1], around[falling ? 2 : 3]);
		return used + put(indices + used, around[falling ? 0 : 1], around[2], around[3]);
	}
	uint32_t middle = (leaf->row + leaf->size / 2) * plan->columns + leaf->column + leaf->size / 2;
	for (uint32_t i = 0; i < count; i++)
		used += put(indices + used, middle, around[i], around[(i + 1) % count]);
	return used;
}

static void count_row(void *context, uint32_t block_row, uint32_t thread)
{
	const struct work *work = context;
	struct merge_row *row = &work->merge->rows[block_row];
	const struct merge_leaf *leaves = leaves_of(work, block_row);
	uint32_t around[4 * LARGEST], count = 0;
	for (uint32_t i = 0; i < row->leaves; i++) {
		uint32_t corners = leaves[i].size == 1 ? 4 : walk_around(work->merge, work->plan, &leaves[i], around);
		count += corners == 4 ? 6 : 3 * corners;
	}
	row->indices = count;
	if (work->depths)
		keep_depths(work, block_row);
}

static void emit_row(void *context, uint32_t block_row, uint32_t thread)
{
	const struct work *work = context;
	const struct merge_row *row = &work->merge->rows[block_row];
	const struct merge_leaf *leaves = leaves_of(work, block_row);
	uint32_t *indices = work->indices + row->indices;
	for (uint32_t i = 0; i < row->leaves; i++)
		indices += emit(work->merge, work->plan, &leaves[i], indices);
}

static uint32_t block_rows(const struct plan *plan)
{
	return 1 + (plan->rows - 2 + LARGEST - 1) / LARGEST;
}

uint32_t merge_find(struct merge *merge, const struct plan *plan, float displacement_tolerance, struct pool *pool)
{
	/* Depth matters only where triangles lie over each other. */
	const struct tolerance tolerance = {displacement_tolerance, plan->folded ? DEPTH_TOLERANCE : INFINITY};
	const uint32_t rows = block_rows(plan);
	struct work work = {.merge = merge, .plan = plan, .tolerance = tolerance, .depths = plan->folded > 0};
	if (!reserve(merge, plan))
		return 0;
	pool_run(pool, divide_row, &work, rows);
	pool_run(pool, count_row, &work, rows);
	uint32_t count = 0;
	for (uint32_t i = 0; i < rows; i++) {
		const uint32_t more = merge->rows[i].indices;
		merge->rows[i].indices = count;
		count += more;
	}
	return count;
}

void merge_write(struct merge *merge, const struct plan *plan, struct pool *pool, uint32_t *indices)
{
	struct work work = {.merge = merge, .plan = plan, .indices = indices};
	pool_run(pool, emit_row, &work, block_rows(plan));
}

void merge_finish(struct merge *merge)
{
	free(merge->used);
	free(merge->flat);
	free(merge->depths);
	free(merge->leaves);
	free(merge->rows);
	*merge = (struct merge){0};
}
