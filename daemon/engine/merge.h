/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Fewer triangles for the same picture: blocks of 2, 4 or 8 cells a side whose
 * vertices lie close enough to the plane of two triangles are drawn as those
 * two; or as a fan around their middle vertex where a neighbour is finer, so
 * that both sides of every edge use the same vertices and nothing gapes.
 */
#ifndef PURSUIT_ENGINE_MERGE_H
#define PURSUIT_ENGINE_MERGE_H

#include <stdint.h>

#include "daemon/engine/plan.h"

struct merge_leaf {
	uint16_t column, row, size; /* in cells */
};

/* The leaves of a row of blocks, the largest ones there are; the outermost row of cells is one by itself. */
struct merge_row {
	uint32_t leaves;  /* how many */
	uint32_t indices; /* how many, then where they go */
};

/* Sizes or-ed, of 2, 4 and 8 cells: of blocks that are flat whatever their depths are, and of those that are with them.
 */
#define MERGE_FLAT(size) (size)
#define MERGE_FLAT_DEPTHS(size) ((size) << 4)

/* Memory that is kept from frame to frame; zeroed at first. */
struct merge {
	uint8_t *used;             /* by vertex: a corner of some leaf */
	uint8_t *flat;             /* by first vertex: MERGE_FLAT() of the blocks that are known to be flat at rest */
	float *depths;             /* by vertex: those that MERGE_FLAT_DEPTHS() is of */
	struct merge_leaf *leaves; /* those of a row of blocks begin where its first row of cells does */
	struct merge_row *rows;
	uint32_t capacity;
	uint32_t width, height, cell; /* of the plans that `flat` is of: positions depend on nothing else */
};

struct pool;

/*
 * Finds the triangles; returns how many indices they have, 3 each, at most plan->index_count. `tolerance`: pixels of
 * displacement (over one real interval) that a vertex may be off. `pool` shares the work: no bit depends on it. 0 if
 * memory is out.
 */
uint32_t merge_find(struct merge *merge, const struct plan *plan, float tolerance, struct pool *pool);

/* Writes those that were found last, of the same plan, to `indices`, which has room for them. */
void merge_write(struct merge *merge, const struct plan *plan, struct pool *pool, uint32_t *indices);

void merge_finish(struct merge *merge);

#endif
