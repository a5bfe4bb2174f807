/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Displacement and depth at every pixel (docs/method.md, 1), kept: for methods that work pixel by pixel.
 */
#ifndef PURSUIT_ANALYSIS_DENSE_H
#define PURSUIT_ANALYSIS_DENSE_H

#include <stddef.h>

#include "daemon/engine/plan.h"

/* A zeroed one is ready for use and is no field of anything. */
struct plan_dense {
	uint32_t width, height; /* of colour */
	enum plan_rest rest;    /* why `ux` and `uy` are 0 all over; PLAN_MOVES: some are not */
	float *ux, *uy;         /* pixels per T, width x height, rows packed */
	float *z;               /* 0 near to 1, the same */
	uint64_t invalid_pixels;
	/* owned storage, reused from frame to frame */
	float *storage;
	size_t capacity; /* pixels */
	void *scratch;
	size_t scratch_bytes;
};

/*
 * Fills it from a frame: cell, threshold and phase of the params do not matter. Reads the planes as plan_make() does,
 * the same bits come out. 0 or -ENOMEM with a sentence. Any thread, one at a time.
 */
int plan_dense_make(struct plan_dense *dense, const struct frame *frame, const struct plan_params *params,
					struct error *error);
/* Memory that it holds. */
uint64_t plan_dense_bytes(const struct plan_dense *dense);
void plan_dense_finish(struct plan_dense *dense);

#endif
