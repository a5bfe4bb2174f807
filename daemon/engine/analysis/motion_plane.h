/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The motion of a frame, kept as its client wrote it: for those that ask how things moved one frame ago. Half floats
 * stay what they are; so do floats, but of a picture of more than PLAN_MOTION_FLOATS pixels they become half floats,
 * so that no picture of some size takes more than 4 bytes a pixel.
 */
#ifndef PURSUIT_ANALYSIS_MOTION_PLANE_H
#define PURSUIT_ANALYSIS_MOTION_PLANE_H

#include <stddef.h>

#include "daemon/engine/analysis/levels.h"
#include "daemon/engine/pool.h"

#define PLAN_MOTION_FLOATS (UINT32_C(1) << 19)

/* A zeroed one is ready for use and holds nothing. */
struct plan_motion_plane {
	uint32_t width, height; /* of colour, whatever the size of the plane; 0: nothing is there */
	bool half;
	uint8_t *pixels; /* x and y of each, rows packed */
	size_t capacity; /* bytes */
	void *scratch;
	size_t scratch_bytes;
};

/* Takes that of a frame that has motion. False if memory is out: then it holds nothing. Any thread, one at a time. */
bool plan_motion_plane_take(struct plan_motion_plane *plane, const struct frame *frame,
							const struct plan_kernels *kernels, struct pool *pool);

/* Its displacement u (docs/method.md, 1) at a pixel: the bits that the plan has for it, but for the rounding above. */
void plan_motion_plane_get(const struct plan_motion_plane *plane, uint32_t i, uint32_t j,
						   const struct plan_scale *scale, float *ux, float *uy);

/* Memory that it holds. */
uint64_t plan_motion_plane_bytes(const struct plan_motion_plane *plane);
void plan_motion_plane_finish(struct plan_motion_plane *plane);

#endif
