/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The field of effective displacement u, row by row (docs/method.md, 1). */
#ifndef PURSUIT_ANALYSIS_FIELD_H
#define PURSUIT_ANALYSIS_FIELD_H

#include "daemon/engine/analysis/levels.h"
#include "daemon/engine/analysis/rows.h"

struct plan_motion {
	const struct plan_kernels *kernels;
	struct plan_rows rows;
	bool half; /* RG16F, else RG32F */
	struct plan_scale scale;
	uint32_t width, height; /* of colour */
	float *ux, *uy;         /* row y of u at slot y % ring, `stride` apart */
	size_t stride;
	uint32_t ring;
	float *decoded;                   /* a row of motion as floats, when half */
	uint8_t slots[PLAN_MAX_CELL + 1]; /* what each slot holds, enum plan_slot */
	uint32_t counted_end;             /* invalid pixels are counted in the rows before this one */
	uint64_t invalid;
	uint8_t *invalid_tiles; /* by tile of PLAN_TILE, several threads may mark them; caller's; NULL: not wanted */
};

/* T / S and the tracking limit. Times in seconds, both known. */
struct plan_scale plan_scale_make(double real_s, double motion_s, uint32_t width, const struct plan_params *params);

/* Ring buffers for cells of that size. */
void plan_motion_init(struct plan_motion *motion, const struct frame *frame, uint32_t cell, struct plan_arena *arena);

/* Forgets those in the ring: rows may begin anywhere. */
void plan_motion_begin(struct plan_motion *motion, uint32_t counted_end);

/* Puts row y, at most height, into its slot; row `height` repeats the last one. Each row once, in order; some may be
 * left out. */
void plan_motion_load(struct plan_motion *motion, uint32_t y);

/* Is any u of row y, in its slot, not 0? */
bool plan_motion_moves(const struct plan_motion *motion, uint32_t y);

/* The rows from y on, all in the ring. */
struct plan_field plan_motion_field(const struct plan_motion *motion, uint32_t y);

#endif
