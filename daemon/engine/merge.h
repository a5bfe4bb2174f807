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
	uint32_t column, row, size; /* in cells */
};

/* The leaves of a row of blocks, the largest ones there are; the outermost row of cells is one by itself. */
struct merge_row {
	uint32_t leaves;  /* how many */
	uint32_t indices; /* how many, then where they go */
};

/* Memory that is kept from frame to frame; zeroed at first. */
struct merge {
	uint8_t *used;             /* by vertex: a corner of some leaf */
	struct merge_leaf *leaves; /* those of a row of blocks begin where its first row of cells does */
	struct merge_row *rows;
	uint32_t capacity;
};

struct pool;

/*
 * Writes triangles, 3 indices each, to `indices`, which has room for plan->index_count; returns how many indices.
 * `tolerance`: pixels of displacement (over one real interval) that a vertex may be off. `pool` shares the work: no bit
 * depends on it. 0 if memory is out.
 */
uint32_t merge_triangles(struct merge *merge, const struct plan *plan, float tolerance, struct pool *pool,
						 uint32_t *indices);
void merge_finish(struct merge *merge);

#endif
