/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* L, in the marked tiles (docs/method.md, 4): levels one after another, each in parallel by rows of tiles. */
#include "daemon/engine/cpu/executor_cpu.h"

struct work {
	struct executor_cpu *executor;
	const struct tiles *tiles;
	const struct canvas *from;
	struct canvas *to;
	uint32_t shift; /* pixels of the picture a texel, as a power of two: of `to` (levels), of `from` (L) */
	float weights[64][4];
};

/* The next run of marked tiles of a row, from tile `at` on; false if there is none. */
static bool next_run(const struct tiles *tiles, uint32_t row, uint32_t at, uint32_t *first, uint32_t *end)
{
	const uint8_t *marked = tiles->marked + (size_t)row * tiles->columns;
	while (at < tiles->columns && !marked[at])
		at++;
	*first = at;
	while (at < tiles->columns && marked[at])
		at++;
	*end = at;
	return *first < *end;
}

static uint32_t lesser(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

static void halve_tiles(void *context, uint32_t item, uint32_t thread)
{
	const struct work *work = context;
	const uint32_t tile = work->tiles->tile_height >> work->shift, bottom = lesser((item + 1) * tile, work->to->height);
	uint32_t first, end;
	for (uint32_t y = item * tile; y < bottom; y++) {
		const int64_t middle = 2 * (int64_t)y;
		const uint8_t *const rows[3] = {canvas_row(work->from, middle - 1), canvas_row(work->from, middle),
										canvas_row(work->from, middle + 1)};
		for (uint32_t at = 0; next_run(work->tiles, item, at, &first, &end); at = end) {
			uint32_t left = first * tile, right = lesser(end * tile, work->to->width);
			if (left < right)
				work->executor->kernels->halve_row(rows, left, right - left, canvas_row(work->to, y));
		}
		canvas_close_row(work->to, y);
	}
}

/* Weights of the uniform cubic B-spline around a texel's fraction f. */
static void spline_weights(float f, float w[4])
{
	float g = 1.0f - f;
	w[0] = g * g * g / 6.0f;
	w[1] = (4.0f + f * f * (3.0f * f - 6.0f)) / 6.0f;
	w[2] = (4.0f + g * g * (3.0f * g - 6.0f)) / 6.0f;
	w[3] = f * f * f / 6.0f;
}

static void smooth_tiles(void *context, uint32_t item, uint32_t thread)
{
	const struct work *work = context;
	const uint32_t tile = work->tiles->tile_height, bottom = lesser((item + 1) * tile, work->to->height);
	uint32_t first, end;
	for (uint32_t y = item * tile; y < bottom; y++) {
		const int64_t base = y >> work->shift;
		const uint8_t *const rows[4] = {canvas_row(work->from, base - 1), canvas_row(work->from, base),
										canvas_row(work->from, base + 1), canvas_row(work->from, base + 2)};
		for (uint32_t at = 0; next_run(work->tiles, item, at, &first, &end); at = end) {
			uint32_t left = first * tile, right = lesser(end * tile, work->to->width);
			work->executor->kernels->spline_row(rows, work->weights[y & ((1u << work->shift) - 1u)], work->weights,
												work->shift, left, right - left, canvas_row(work->to, y));
		}
		canvas_close_row(work->to, y);
	}
}

static int make_levels(struct engine *engine, struct error *error)
{
	struct executor_cpu *executor = cpu_of(engine);
	const struct canvas *below = cpu_picture(engine, PICTURE_ORIGINAL);
	for (uint32_t i = 0; i < engine->params.blur_level; i++) {
		struct canvas *level = &executor->levels[i];
		int result = canvas_resize(level, (below->width + 1) / 2, (below->height + 1) / 2, error);
		if (result < 0)
			return result;
		struct work work = {
			.executor = executor, .tiles = &engine->mesh.levels, .from = below, .to = level, .shift = i + 1};
		pool_run(executor->base.pool, halve_tiles, &work, engine->mesh.levels.rows);
		below = level;
	}
	return 0;
}

static int make_low(struct engine *engine, struct error *error)
{
	struct executor_cpu *executor = cpu_of(engine);
	struct canvas *low = &executor->pictures[PICTURE_LOW];
	const uint32_t shift = engine->params.blur_level;
	struct work work = {.executor = executor,
						.tiles = &engine->mesh.low,
						.from = &executor->levels[shift - 1],
						.to = low,
						.shift = shift};
	int result = canvas_resize(low, engine->width, engine->height, error);
	if (result < 0)
		return result;
	for (uint32_t i = 0; i < 1u << shift; i++)
		spline_weights((float)i / (float)(1u << shift), work.weights[i]);
	pool_run(executor->base.pool, smooth_tiles, &work, engine->mesh.low.rows);
	return 0;
}

static int run(struct engine *engine, struct error *error)
{
	if (engine->levels_everywhere) {
		tiles_mark_all(&engine->mesh.levels);
		tiles_mark_all(&engine->mesh.low);
	}
	int result = make_levels(engine, error);
	if (result == 0)
		result = make_low(engine, error);
	engine->levels_made = result < 0 ? LEVELS_NONE : engine->levels_everywhere ? LEVELS_ALL : LEVELS_MARKED;
	return result;
}

const struct pass cpu_pass_pyramid = {.run = run};
