/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/analysis/job.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/analysis/facts.h"
#include "daemon/engine/analysis/grid.h"

static int depth_plane_of(const struct frame *frame)
{
	int index = plan_find_plane(&frame->header, PURSUIT_ROLE_DEPTH);
	bool absent = index < 0 || !frame->planes[index] || frame->header.depth_kind == PURSUIT_DEPTH_NONE;
	return absent ? -1 : index;
}

bool plan_job_begin(struct plan *plan, const struct frame *frame, const struct plan_params *params,
					struct plan_job *job)
{
	struct plan_intervals intervals = plan_begin(plan, frame, params);
	if (plan->rest != PLAN_MOVES)
		return false;
	uint32_t threshold = plan_threshold(params);
	*job = (struct plan_job){
		.width = plan->width,
		.height = plan->height,
		.cell = plan->cell,
		.columns = (plan->width + plan->cell - 1) / plan->cell + 2,
		.rows = (plan->height + plan->cell - 1) / plan->cell + 2,
		.tile_columns = plan_tiles_along(plan->width),
		.tiles = plan_tiles_along(plan->width) * plan_tiles_along(plan->height),
		.least = (float)(threshold * threshold) / 16.0f,
		.scale = plan_scale_make(plan->real_interval_s, (double)intervals.motion * 1e-9, plan->width, params),
		.depth = plan_depth_of(&frame->header),
		.motion_plane = plan_find_plane(&frame->header, PURSUIT_ROLE_MOTION),
		.depth_plane = depth_plane_of(frame),
	};
	return true;
}

static void lay_out(struct plan_grid *grid, uint8_t **tiles, const struct frame *frame, const struct plan_job *job,
					struct plan_arena *arena)
{
	*tiles = plan_arena_take(arena, job->tiles);
	plan_grid_init(grid, frame, job->cell, 1, arena);
}

static int prepare(struct plan *plan, struct plan_grid *grid, uint8_t **tiles, const struct frame *frame,
				   const struct plan_job *job)
{
	struct plan_arena arena = {NULL, 0};
	lay_out(grid, tiles, frame, job, &arena);
	if (plan_scratch_reserve(plan, &arena) < 0)
		return -ENOMEM;
	lay_out(grid, tiles, frame, job, &arena);
	return plan_grid_reserve(plan);
}

static void take_vertices(struct plan_grid *grid, const struct plan_vertex *vertices)
{
	struct plan *plan = grid->plan;
	memcpy(plan->vertices, vertices, (size_t)plan->columns * plan->rows * sizeof(*vertices));
	plan_grid_take(grid);
	plan->snapped = grid->counts.snapped;
	plan->folded = grid->counts.folded;
	plan->doubtful = grid->counts.doubtful;
	plan->max_displacement = grid->counts.max_displacement;
	plan->index_count = 6 * (plan->columns - 1) * (plan->rows - 1);
}

int plan_job_end(struct plan *plan, const struct frame *frame, const struct plan_job *job,
				 const struct plan_found *found, struct error *error)
{
	if (!plan->kernels)
		plan->kernels = plan_level_kernels(plan_level_best());
	struct plan_grid grid = {.kernels = plan->kernels, .plan = plan};
	uint8_t *tiles;
	if (prepare(plan, &grid, &tiles, frame, job) < 0)
		return plan_out_of_memory(plan, error);
	plan->invalid_pixels = found->invalid_pixels;
	for (uint32_t i = 0; i < job->tiles && found->invalid_pixels; i++)
		tiles[i] = found->invalid_tiles[i] != 0;
	plan->invalid_tiles = found->invalid_pixels ? tiles : NULL;
	if (found->moves) {
		take_vertices(&grid, found->vertices);
		return 0;
	}
	plan->rest = PLAN_STILL;
	plan->columns = plan->rows = 0;
	return 0;
}
