/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/analysis/motion_plane.h"

#include <stdlib.h>
#include <string.h>

#include "daemon/engine/analysis/rows.h"
#include "daemon/engine/analysis/values.h"

/* So that threads share them out evenly and ask seldom. */
#define ROWS_OF_ITEM 32u

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

/* Each thread has a look of its own at the rows. */
struct taking {
	struct plan_motion_plane *plane;
	const struct plan_kernels *kernels;
	struct plan_rows rows[POOL_MAX_THREADS];
};

static size_t init_rows(struct taking *taking, const struct frame *frame, uint32_t threads, void *scratch)
{
	struct plan_arena arena = {scratch, 0};
	for (uint32_t i = 0; i < threads; i++)
		plan_rows_init(&taking->rows[i], frame, PURSUIT_ROLE_MOTION, &arena);
	return arena.used;
}

static size_t row_bytes_of(const struct plan_motion_plane *plane)
{
	return (plane->half ? 4 : 8) * (size_t)plane->width;
}

static void take_rows(void *context, uint32_t item, uint32_t thread)
{
	struct taking *taking = context;
	const struct plan_motion_plane *plane = taking->plane;
	struct plan_rows *rows = &taking->rows[thread];
	const size_t bytes = row_bytes_of(plane);
	const bool same = plane->half == (rows->pixel_bytes == 4);
	for (uint32_t y = item * ROWS_OF_ITEM; y < (item + 1) * ROWS_OF_ITEM && y < plane->height; y++) {
		const void *row = plan_rows_get(rows, y);
		void *to = plane->pixels + bytes * y;
		if (same)
			memcpy(to, row, bytes);
		else
			taking->kernels->encode_half(row, 2 * (size_t)plane->width, to);
	}
}

bool plan_motion_plane_take(struct plan_motion_plane *plane, const struct frame *frame,
							const struct plan_kernels *kernels, struct pool *pool)
{
	struct taking taking = {.plane = plane, .kernels = kernels};
	const uint32_t threads = pool_threads(pool);
	const size_t scratch_bytes = init_rows(&taking, frame, threads, NULL);
	const struct plan_rows *rows = &taking.rows[0];
	plane->width = rows->colour_width;
	plane->height = rows->colour_height;
	plane->half = rows->pixel_bytes == 4 || (uint64_t)plane->width * plane->height > PLAN_MOTION_FLOATS;
	if (!reserve(plane, row_bytes_of(plane) * plane->height, scratch_bytes)) {
		plane->width = plane->height = 0;
		return false;
	}
	init_rows(&taking, frame, threads, plane->scratch);
	pool_run(pool, take_rows, &taking, (plane->height + ROWS_OF_ITEM - 1) / ROWS_OF_ITEM);
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
