/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Colour and UI into pictures of our own, as the display's code values and opaque. It only begins here: the planes are
 * taken while the frame is analysed, and engine_begin() does not return before they are.
 */
#include "daemon/engine/cpu/executor_cpu.h"

#include <errno.h>
#include <stdlib.h>

#include "daemon/engine/pass.h"

#define ROWS_OF_ITEM 16u

static void take_rows(struct engine *engine, enum picture_id id, uint32_t item)
{
	struct intake *intake = &cpu_of(engine)->intake;
	bool opaque = id == PICTURE_ORIGINAL;
	int index = opaque ? intake->color : intake->ui;
	const struct convert *convert = opaque ? &engine->color_convert : &engine->ui_convert;
	const struct pursuit_plane *plane = &engine->job.frame->header.planes[index];
	const struct canvas *canvas = &cpu_of(engine)->pictures[id];
	struct bounds bounds = {0};
	for (uint32_t y = item * ROWS_OF_ITEM; y < (item + 1) * ROWS_OF_ITEM && y < plane->height; y++) {
		if (opaque && !planes_changed(engine, y, 1))
			continue;
		const uint8_t *from = engine->job.frame->planes[index] + (size_t)y * plane->stride;
		convert_row(convert, canvas_row(canvas, y), from, plane->width, opaque);
		if (opaque)
			canvas_close_row(canvas, y);
		else
			bounds_widen(&bounds, canvas_row(canvas, y), plane->width, y);
	}
	if (!opaque)
		intake->bounds[item] = bounds;
}

static void take(void *context, uint32_t item, uint32_t thread)
{
	struct intake *intake = context;
	bool ui = item >= intake->color_items;
	take_rows(intake->engine, ui ? PICTURE_UI : PICTURE_ORIGINAL, ui ? item - intake->color_items : item);
}

static int reserve(struct intake *intake, size_t blocks, struct error *error)
{
	if (blocks <= intake->bounds_capacity)
		return 0;
	free(intake->bounds);
	intake->bounds = malloc(blocks * sizeof(*intake->bounds));
	intake->bounds_capacity = intake->bounds ? blocks : 0;
	return intake->bounds ? 0 : error_set(error, -ENOMEM, "out of memory for %zu blocks of rows", blocks);
}

static int run(struct engine *engine, struct error *error)
{
	struct executor_cpu *executor = cpu_of(engine);
	struct intake *intake = &executor->intake;
	int result = planes_prepare(engine, &intake->color, &intake->ui, error);
	if (result < 0)
		return result;
	uint32_t items = (engine->height + ROWS_OF_ITEM - 1) / ROWS_OF_ITEM;
	if (engine->damage.known)
		cpu_picture(engine, PICTURE_ORIGINAL);
	layers_clear(&executor->layers);
	if (!planes_changed(engine, 0, engine->height)) {
		report_leave_out(&engine->report, "upload", "unchanged");
		return 0;
	}
	result = canvas_resize(&executor->pictures[PICTURE_ORIGINAL], engine->width, engine->height, error);
	if (result == 0 && intake->ui >= 0)
		result = canvas_resize(&executor->pictures[PICTURE_UI], engine->width, engine->height, error);
	if (result == 0)
		result = reserve(intake, items, error);
	if (result < 0)
		return result;
	intake->engine = engine;
	intake->color_items = items;
	intake->under_way = true;
	pool_start(executor->base.pool, take, intake, intake->ui >= 0 ? 2 * items : items);
	engine->report.bytes_up += 4 * (uint64_t)engine->width * engine->height * (intake->ui >= 0 ? 2 : 1);
	return 0;
}

static void unite(struct bounds *all, const struct bounds *one)
{
	if (bounds_empty(one))
		return;
	bool first = bounds_empty(all);
	all->left = first || one->left < all->left ? one->left : all->left;
	all->right = first || one->right > all->right ? one->right : all->right;
	all->top = first ? one->top : all->top;
	all->bottom = one->bottom;
}

void cpu_finish_intake(struct engine *engine)
{
	struct executor_cpu *executor = cpu_of(engine);
	if (!executor->intake.under_way)
		return;
	executor->intake.under_way = false;
	pool_finish(executor->base.pool);
	for (uint32_t i = 0; i < executor->intake.color_items && executor->intake.ui >= 0; i++)
		unite(&engine->ui_bounds, &executor->intake.bounds[i]);
}

static int analyse(struct engine *engine, struct error *error)
{
	int result = pass_analyse.run(engine, error);
	cpu_finish_intake(engine);
	return result;
}

const struct pass cpu_pass_upload = {.run = run};
const struct pass cpu_pass_analyse = {.on_cpu = true, .run = analyse};
