/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/analysis/motion_plane.h"

#include <stdlib.h>
#include <string.h>

#include "daemon/engine/analysis/rows.h"
#include "daemon/engine/analysis/values.h"

static bool reserve(struct plan_motion_plane *plane, size_t bytes, size_t scratch_bytes)
{
	if (bytes > plane->capacity) {
		free(plane->pixels);
		plane->pixels = malloc(bytes);
		plane->capacity = plane->pixels ? bytes : 0;
	}
	if (scratch_bytes > plane->scratch_bytes) {
		free(plane->scratch);
		plane->scratch = aligned_alloc(64, scratch_bytes);
		plane->scratch_bytes = plane->scratch ? scratch_bytes : 0;
	}
	return plane->pixels && (plane->scratch || !scratch_bytes);
}

bool plan_motion_plane_take(struct plan_motion_plane *plane, const struct frame *frame,
							const struct plan_kernels *kernels)
{
	struct plan_arena arena = {NULL, 0};
	struct plan_rows rows;
	plan_rows_init(&rows, frame, PURSUIT_ROLE_MOTION, &arena);
	const uint32_t width = rows.colour_width, height = rows.colour_height;
	const bool given_half = rows.pixel_bytes == 4;
	const bool half = given_half || (uint64_t)width * height > PLAN_MOTION_FLOATS;
	const size_t row_bytes = (half ? 4 : 8) * (size_t)width;
	plane->width = plane->height = 0;
	if (!reserve(plane, row_bytes * height, arena.used))
		return false;
	arena = (struct plan_arena){plane->scratch, 0};
	plan_rows_init(&rows, frame, PURSUIT_ROLE_MOTION, &arena);
	for (uint32_t y = 0; y < height; y++) {
		const void *row = plan_rows_get(&rows, y);
		void *to = plane->pixels + row_bytes * y;
		if (half == given_half)
			memcpy(to, row, row_bytes);
		else
			kernels->encode_half(row, 2 * (size_t)width, to);
	}
	plane->half = half;
	plane->width = width;
	plane->height = height;
	return true;
}

void plan_motion_plane_get(const struct plan_motion_plane *plane, uint32_t i, uint32_t j,
						   const struct plan_scale *scale, float *ux, float *uy)
{
	const size_t at = (size_t)j * plane->width + i;
	float motion[2];
	if (plane->half) {
		uint16_t halves[2];
		memcpy(halves, plane->pixels + 4 * at, sizeof(halves));
		motion[0] = plan_half_value(halves[0]);
		motion[1] = plan_half_value(halves[1]);
	} else {
		memcpy(motion, plane->pixels + 8 * at, sizeof(motion));
	}
	plan_displacement(motion[0], motion[1], scale, ux, uy);
}

uint64_t plan_motion_plane_bytes(const struct plan_motion_plane *plane)
{
	return plane->capacity + plane->scratch_bytes;
}

void plan_motion_plane_finish(struct plan_motion_plane *plane)
{
	free(plane->pixels);
	free(plane->scratch);
	*plane = (struct plan_motion_plane){0};
}
