/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/analysis/dense.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/analysis/facts.h"
#include "daemon/engine/analysis/field.h"

/* u row by row, two rows in the ring. */
#define RING_CELL 1u

static int reserve(struct plan_dense *dense)
{
	size_t pixels = (size_t)dense->width * dense->height;
	if (pixels > dense->capacity) {
		free(dense->storage);
		dense->capacity = 0;
		dense->storage = malloc(3 * pixels * sizeof(float));
		if (!dense->storage)
			return -ENOMEM;
		dense->capacity = pixels;
	}
	dense->ux = dense->storage;
	dense->uy = dense->ux + pixels;
	dense->z = dense->uy + pixels;
	return 0;
}

static int reserve_scratch(struct plan_dense *dense, size_t bytes)
{
	if (bytes <= dense->scratch_bytes)
		return 0;
	free(dense->scratch);
	dense->scratch_bytes = 0;
	dense->scratch = aligned_alloc(64, bytes);
	if (!dense->scratch)
		return -ENOMEM;
	dense->scratch_bytes = bytes;
	return 0;
}

static int read_depth(struct plan_dense *dense, const struct plan_kernels *kernels, const struct frame *frame)
{
	struct plan_arena arena = {NULL, 0};
	struct plan_rows rows;
	const struct plan_depth depth = plan_depth_of(&frame->header);
	size_t width = dense->width;
	plan_rows_init(&rows, frame, PURSUIT_ROLE_DEPTH, &arena);
	if (reserve_scratch(dense, arena.used) < 0)
		return -ENOMEM;
	arena = (struct plan_arena){dense->scratch, 0};
	plan_rows_init(&rows, frame, PURSUIT_ROLE_DEPTH, &arena);
	if (!rows.data || frame->header.depth_kind == PURSUIT_DEPTH_NONE) {
		for (size_t i = 0; i < width * dense->height; i++)
			dense->z[i] = 0.5f;
		return 0;
	}
	for (uint32_t y = 0; y < dense->height; y++)
		kernels->depth_row(plan_rows_get(&rows, y), width, &depth, dense->z + y * width);
	return 0;
}

static int read_motion(struct plan_dense *dense, struct plan_motion *motion, const struct frame *frame)
{
	struct plan_arena arena = {NULL, 0};
	size_t width = dense->width;
	bool moves = false;
	plan_motion_init(motion, frame, RING_CELL, &arena);
	if (reserve_scratch(dense, arena.used) < 0)
		return -ENOMEM;
	arena = (struct plan_arena){dense->scratch, 0};
	plan_motion_init(motion, frame, RING_CELL, &arena);
	for (uint32_t y = 0; y < dense->height; y++) {
		plan_motion_load(motion, y);
		moves |= plan_motion_moves(motion, y);
		struct plan_field row = plan_motion_field(motion, y);
		memcpy(dense->ux + y * width, row.ux[0], width * sizeof(float));
		memcpy(dense->uy + y * width, row.uy[0], width * sizeof(float));
	}
	dense->invalid_pixels = motion->invalid;
	if (!moves)
		dense->rest = PLAN_STILL;
	return 0;
}

static int fill(struct plan_dense *dense, const struct frame *frame, const struct plan_params *params)
{
	const struct plan_kernels *kernels = plan_level_kernels(plan_level_best());
	struct plan_intervals intervals = plan_intervals_of(&frame->header, params->real_interval_ns);
	dense->rest = plan_rest_of(frame, &intervals);
	dense->invalid_pixels = 0;
	if (reserve(dense) < 0 || read_depth(dense, kernels, frame) < 0)
		return -ENOMEM;
	if (dense->rest != PLAN_MOVES) {
		memset(dense->ux, 0, 2 * (size_t)dense->width * dense->height * sizeof(float));
		return 0;
	}
	struct plan_motion motion = {.kernels = kernels};
	motion.scale =
		plan_scale_make((double)intervals.real * 1e-9, (double)intervals.motion * 1e-9, dense->width, params);
	return read_motion(dense, &motion, frame);
}

int plan_dense_make(struct plan_dense *dense, const struct frame *frame, const struct plan_params *params,
					struct error *error)
{
	int colour = plan_find_plane(&frame->header, PURSUIT_ROLE_COLOR);
	dense->width = colour < 0 ? 0 : frame->header.planes[colour].width;
	dense->height = colour < 0 ? 0 : frame->header.planes[colour].height;
	if (fill(dense, frame, params) == 0)
		return 0;
	uint32_t width = dense->width, height = dense->height;
	dense->width = dense->height = 0;
	return error_set(error, -ENOMEM, "no memory for the motion of a %u x %u picture, pixel by pixel", width, height);
}

uint64_t plan_dense_bytes(const struct plan_dense *dense)
{
	return 3 * sizeof(float) * (uint64_t)dense->capacity + dense->scratch_bytes;
}

void plan_dense_finish(struct plan_dense *dense)
{
	free(dense->storage);
	free(dense->scratch);
	*dense = (struct plan_dense){0};
}
