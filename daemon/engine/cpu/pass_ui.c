/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The UI layer over everything else, in code values, never warped or blurred. */
#include "daemon/engine/cpu/executor_cpu.h"

#define ROWS_OF_ITEM 16u

struct work {
	struct executor_cpu *executor;
	const struct bounds *bounds;
	struct rows shown;
};

static const char *prepare(struct engine *engine)
{
	return bounds_empty(&engine->ui_bounds) ? "absent" : NULL;
}

static void blend(void *context, uint32_t item, uint32_t thread)
{
	const struct work *work = context;
	const struct bounds *bounds = work->bounds;
	const struct canvas *ui = &work->executor->pictures[PICTURE_UI];
	uint32_t top = bounds->top + item * ROWS_OF_ITEM;
	size_t left = 4 * (size_t)bounds->left;
	for (uint32_t y = top; y < top + ROWS_OF_ITEM && y < bounds->bottom; y++)
		work->executor->kernels->blend_row(work->shown.data + y * work->shown.stride + left, canvas_row(ui, y) + left,
										   bounds->right - bounds->left);
}

static int run(struct engine *engine, struct error *error)
{
	struct work work = {.executor = cpu_of(engine), .bounds = &engine->ui_bounds};
	int result = cpu_shown(engine, &work.shown, error);
	if (result < 0)
		return result;
	if (engine->job.picture != PICTURE_SHOWN)
		cpu_copy(work.executor, cpu_picture(engine, engine->job.picture), &work.shown);
	uint32_t rows = work.bounds->bottom - work.bounds->top;
	pool_run(work.executor->base.pool, blend, &work, (rows + ROWS_OF_ITEM - 1) / ROWS_OF_ITEM);
	engine->job.picture = PICTURE_SHOWN;
	return 0;
}

const struct pass cpu_pass_ui = {.prepare = prepare, .run = run};
