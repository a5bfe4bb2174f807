/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What damage leaves of the plan made before (proto/frame.h): outside the rectangles nothing moves, so cell rows that
 * none of them touches need no look at their motion; and rows of vertices that did not move either lie where they lay.
 *
 * That takes a frame before whose motion was all numbers, since those that are none are counted, and depth and motion
 * as large as colour. Otherwise all is looked at. What a client says that is not so lasts until it says nothing.
 */
#ifndef PURSUIT_ANALYSIS_KEPT_H
#define PURSUIT_ANALYSIS_KEPT_H

#include "daemon/engine/analysis/levels.h"

struct plan_kept {
	bool clean; /* the frame that the plan is of was looked at, and all of its motion were numbers */
	/* What z of vertices depends on. */
	uint32_t width, height, cell, depth_kind;
	struct plan_depth depth;
	uint32_t capacity; /* rows of vertices */
	uint8_t rows[];    /* PLAN_KEPT_* of each */
};

#define PLAN_KEPT_TOUCHED 1u /* pixels of its cell row, or of the row of pixels below, may have changed */
#define PLAN_KEPT_STILL 2u   /* its vertices are in the plan, and do not move */

/* Before anything of the plan is made for this frame: does its damage count? */
bool plan_kept_follows(const struct plan *plan, const struct frame *frame, const struct plan_params *params);

/* Makes room for the rows of a plan whose width, height and cell are set. 0 or -ENOMEM. */
int plan_kept_reserve(struct plan *plan);

/* Marks the rows; without `follows` all are touched, and none is kept. */
void plan_kept_begin(struct plan *plan, const struct frame *frame, const struct plan_params *params, bool follows);

/* The plan is made, by looking. */
void plan_kept_end(struct plan *plan);

/* Of a row of vertices. */
static inline bool plan_kept_touched(const struct plan *plan, uint32_t row)
{
	return plan->kept->rows[row] & PLAN_KEPT_TOUCHED;
}

static inline bool plan_kept_still(const struct plan *plan, uint32_t row)
{
	return plan->kept->rows[row] & PLAN_KEPT_STILL;
}

/* Its vertices have been written. */
static inline void plan_kept_put(struct plan *plan, uint32_t row, bool still)
{
	plan->kept->rows[row] = (uint8_t)(still ? PLAN_KEPT_TOUCHED | PLAN_KEPT_STILL : PLAN_KEPT_TOUCHED);
}

#endif
