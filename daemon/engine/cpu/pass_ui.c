/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The UI layer over everything else, in code values, never warped or blurred. */
#include "daemon/engine/cpu/executor_cpu.h"

struct work {
	struct executor_cpu *executor;
	const struct bounds *bounds;
	const struct sheet *shown;
};

static const char *prepare(struct engine *engine)
{
	return bounds_empty(&engine->ui_bounds) ? "absent" : NULL;
}

static uint32_t lesser(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

static uint32_t greater(uint32_t a, uint32_t b)
{
	return a > b ? a : b;
}

/* Tiles `first` to `end` - 1 of a row of them, as far as there is a UI. */
static void blend_tiles(const struct work *work, uint32_t row, uint32_t first, uint32_t end)
{
	const struct bounds *bounds = work->bounds;
	const struct canvas *ui = &work->executor->pictures[PICTURE_UI];
	const uint32_t left = greater(first * TILE_WIDTH, bounds->left), right = lesser(end * TILE_WIDTH, bounds->right);
	const uint32_t bottom = lesser((row + 1) * TILE_HEIGHT, bounds->bottom);
	for (uint32_t y = greater(row * TILE_HEIGHT, bounds->top); y < bottom; y++)
		work->executor->kernels->blend_row(work->shown->data + y * work->shown->stride + 4 * (size_t)left,
										   canvas_row(ui, y) + 4 * (size_t)left, right - left);
}

/* What is there from before has its UI. */
static void blend(void *context, uint32_t item, uint32_t thread)
{
	const struct work *work = context;
	const uint32_t row = work->bounds->top / TILE_HEIGHT + item, columns = work->executor->contents.columns;
	const uint32_t last = (work->bounds->right - 1) / TILE_WIDTH;
	for (uint32_t column = work->bounds->left / TILE_WIDTH; column <= last; column++) {
		const uint32_t first = column;
		while (column <= last && sheet_is_fresh(work->shown, row * columns + column))
			column++;
		if (first < column)
			blend_tiles(work, row, first, column);
	}
}

static int run(struct engine *engine, struct error *error)
{
	struct work work = {.executor = cpu_of(engine), .bounds = &engine->ui_bounds};
	const enum picture_id id = engine->job.picture;
	int result = cpu_shown(engine, &work.shown, error);
	if (result < 0)
		return result;
	if (id != PICTURE_SHOWN)
		cpu_copy(work.executor, id, cpu_picture(engine, id));
	const uint32_t first = work.bounds->top / TILE_HEIGHT, last = (work.bounds->bottom - 1) / TILE_HEIGHT;
	pool_run(work.executor->base.pool, blend, &work, last + 1 - first);
	engine->job.picture = PICTURE_SHOWN;
	return 0;
}

const struct pass cpu_pass_ui = {.prepare = prepare, .run = run};
