/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The analysis of a frame in bands of cell rows, which threads share. Whatever
 * the bands, the plan is the same: a band loads the row of pixels below it too,
 * and what lies between two bands is made last.
 */
#ifndef PURSUIT_ANALYSIS_BANDS_H
#define PURSUIT_ANALYSIS_BANDS_H

#include "daemon/engine/analysis/grid.h"
#include "daemon/engine/pool.h"

#define PLAN_MAX_BANDS 32u

/* What a thread works with. */
struct plan_bench {
	struct plan_motion motion;
	struct plan_grid grid;
};

struct plan_bands {
	/* Set by the caller. */
	struct plan *plan;
	struct pool *pool; /* NULL: alone */
	const struct plan_kernels *kernels;
	struct plan_scale scale;
	uint32_t threshold;
	/* The rest is not. */
	uint32_t count, cells_y;
	bool moves[PLAN_MAX_BANDS]; /* its vertices are in the plan */
	struct plan_bench benches[POOL_MAX_THREADS];
	uint8_t *invalid_tiles;
};

/* Buffers for all threads; run with an arena without base first to learn how much they take. */
void plan_bands_init(struct plan_bands *bands, const struct frame *frame, struct plan_arena *arena);

/* Fills the plan, for whose vertices and triangles there is room: all but its head. */
void plan_bands_run(struct plan_bands *bands);

#endif
