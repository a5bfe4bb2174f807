/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/analysis/bands.h"

#include <string.h>

#include "daemon/engine/analysis/kept.h"

/* Bands a thread, so that none waits long for another; and pixels a band, so that rows loaded twice are few. */
#define BANDS_OF_THREAD 4u
#define LEAST_ROWS 32u

static uint32_t count_bands(const struct plan_bands *bands)
{
	const uint32_t threads = pool_threads(bands->pool), most = bands->plan->height / LEAST_ROWS;
	uint32_t count = threads > 1 ? BANDS_OF_THREAD * threads : 1;
	count = count < most ? count : most;
	return count > 1 ? count < bands->cells_y ? count : bands->cells_y : 1;
}

static void init_bench(struct plan_bands *bands, struct plan_bench *bench, const struct frame *frame,
					   struct plan_arena *arena)
{
	const uint32_t cell = bands->plan->cell;
	*bench = (struct plan_bench){.motion = {.kernels = bands->kernels, .scale = bands->scale},
								 .grid = {.kernels = bands->kernels, .plan = bands->plan, .motion = &bench->motion}};
	plan_motion_init(&bench->motion, frame, cell, arena);
	plan_grid_init(&bench->grid, frame, cell, bands->threshold, arena);
	bench->motion.invalid_tiles = bands->invalid_tiles;
}

void plan_bands_init(struct plan_bands *bands, const struct frame *frame, struct plan_arena *arena)
{
	const struct plan *plan = bands->plan;
	const size_t tiles = (size_t)plan_tiles_along(plan->width) * plan_tiles_along(plan->height);
	bands->invalid_tiles = plan_arena_take(arena, tiles);
	if (arena->base)
		memset(bands->invalid_tiles, 0, tiles);
	for (uint32_t i = 0; i < pool_threads(bands->pool); i++)
		init_bench(bands, &bands->benches[i], frame, arena);
	bands->cells_y = bands->benches[0].grid.cells_y;
	bands->count = count_bands(bands);
}

static uint32_t begin_of(const struct plan_bands *bands, uint32_t band)
{
	return (uint32_t)((uint64_t)bands->cells_y * band / bands->count);
}

/* Rows of pixels up to `end`, those before `*loaded` are in the ring already. Does any from `start` on move? */
static bool load_rows(struct plan_motion *motion, uint32_t start, uint32_t end, uint32_t *loaded)
{
	bool moves = false;
	for (uint32_t y = start; y <= end; y++) {
		if (y >= *loaded)
			plan_motion_load(motion, y);
		moves |= plan_motion_moves(motion, y);
	}
	*loaded = end + 1;
	return moves;
}

/* Cell rows from the top; the vertices begin with the first that moves. */
static bool look(struct plan_motion *motion, struct plan_grid *grid, uint32_t first, uint32_t last)
{
	const uint32_t cell = grid->plan->cell, height = grid->plan->height;
	uint32_t loaded = 0;
	bool begun = false;
	plan_motion_begin(motion, last < grid->cells_y ? last * cell : height);
	for (uint32_t r = first; r < last; r++) {
		uint32_t start = r * cell, end = height - start < cell ? height : start + cell;
		bool moves = plan_kept_touched(grid->plan, r + 1) && load_rows(motion, start, end, &loaded);
		if (moves && !begun) {
			plan_grid_begin(grid, first);
			begun = true;
			for (uint32_t still = first; still < r; still++)
				plan_grid_still_row(grid, still);
		}
		if (moves)
			plan_grid_moving_row(grid, r);
		else if (begun)
			plan_grid_still_row(grid, r);
	}
	if (begun)
		plan_grid_end(grid, last);
	return begun;
}

static void look_at_band(void *context, uint32_t band, uint32_t thread)
{
	struct plan_bands *bands = context;
	struct plan_bench *bench = &bands->benches[thread];
	bands->moves[band] = look(&bench->motion, &bench->grid, begin_of(bands, band), begin_of(bands, band + 1));
}

/* Where nothing moves, once it is known that something else does. */
static void put_still_band(void *context, uint32_t band, uint32_t thread)
{
	struct plan_bands *bands = context;
	struct plan_grid *grid = &bands->benches[thread].grid;
	if (bands->moves[band])
		return;
	plan_grid_begin(grid, begin_of(bands, band));
	for (uint32_t r = begin_of(bands, band); r < begin_of(bands, band + 1); r++)
		plan_grid_still_row(grid, r);
	plan_grid_end(grid, begin_of(bands, band + 1));
}

static void put_counts(struct plan_bands *bands)
{
	struct plan *plan = bands->plan;
	for (uint32_t i = 0; i < pool_threads(bands->pool); i++) {
		const struct plan_bench *bench = &bands->benches[i];
		const struct plan_grid_counts *counts = &bench->grid.counts;
		plan->snapped += counts->snapped;
		plan->folded += counts->folded;
		plan->doubtful += counts->doubtful;
		plan->invalid_pixels += bench->motion.invalid;
		if (counts->max_displacement > plan->max_displacement)
			plan->max_displacement = counts->max_displacement;
	}
	plan->invalid_tiles = plan->invalid_pixels ? bands->invalid_tiles : NULL;
	plan->index_count = plan->columns ? 6 * (plan->columns - 1) * (plan->rows - 1) : 0;
}

void plan_bands_run(struct plan_bands *bands)
{
	uint32_t moving = 0;
	pool_run(bands->pool, look_at_band, bands, bands->count);
	for (uint32_t i = 0; i < bands->count; i++)
		moving += bands->moves[i];
	if (!moving) {
		bands->plan->rest = PLAN_STILL;
		bands->plan->columns = bands->plan->rows = 0;
	} else if (moving < bands->count) {
		pool_run(bands->pool, put_still_band, bands, bands->count);
	}
	for (uint32_t i = 1; i < bands->count && moving; i++)
		plan_grid_join(&bands->benches[0].grid, begin_of(bands, i));
	put_counts(bands);
}
