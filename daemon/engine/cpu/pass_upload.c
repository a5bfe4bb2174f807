/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Colour and UI into pictures of our own, as the display's code values and opaque. It only begins here: the planes are
 * taken while the frame is analysed, and engine_begin() does not return before they are.
 *
 * After a frame that did not move, rows are looked at first, and those that are as they were are left there; if all
 * are, the picture is what it was, and presenters that have it are given none. A frame that does differ costs a look at
 * a few rows, and none for the next few frames. One thread looks: memory is what it waits for, and waking another costs
 * more than it spares.
 */
#include "daemon/engine/cpu/executor_cpu.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/analysis/levels.h"
#include "daemon/engine/pass.h"

#define ROWS_OF_ITEM 16u
/* Frames that are not looked at, after one that was and differed. */
#define LOOK_AGAIN_AFTER 15u

static size_t pixel_bytes(const struct pursuit_plane *plane)
{
	return plane->format == PURSUIT_FORMAT_RGBA16F ? 8 : 4;
}

/* Is the row as it was in the frame before? Only that of a frame that is looked at may be. */
static bool as_it_was(struct intake *intake, uint32_t row, const uint8_t *from, const struct pursuit_plane *plane)
{
	if (!intake->looks || atomic_load_explicit(&intake->differs, memory_order_relaxed))
		return false;
	const uint64_t hash = intake->hash_row(from, pixel_bytes(plane) * plane->width), before = intake->hashes[row];
	intake->hashes[row] = hash;
	if (intake->compares && hash != before)
		atomic_store_explicit(&intake->differs, true, memory_order_relaxed);
	return intake->compares && hash == before;
}

/* A row on its way in. */
struct row {
	struct contents *contents;
	const struct convert *convert;
	const uint8_t *from;
	size_t pixel_bytes;
	uint8_t *to; /* of the canvas */
	uint32_t width, first_tile;
	bool opaque, outermost; /* the first or the last of the picture */
};

static void convert_part(const struct row *row, uint8_t *to, uint32_t left, uint32_t right)
{
	convert_row(row->convert, to, row->from + row->pixel_bytes * left, right - left, row->opaque);
}

/* The part of a row in a tile that may be as it was; true if it was not. Each pixel is read once. */
static bool put_tile(const struct row *row, uint32_t left, uint32_t right)
{
	uint8_t pixels[4 * TILE_WIDTH], *to = row->to + 4 * (size_t)left;
	const size_t bytes = 4 * (size_t)(right - left);
	convert_part(row, pixels, left, right);
	if (memcmp(to, pixels, bytes) == 0)
		return false;
	memcpy(to, pixels, bytes);
	contents_change(row->contents, row->first_tile + left / TILE_WIDTH);
	return true;
}

/* Nothing is written where nothing differs; true if something does on the border of the picture. */
static bool put_row(const struct row *row)
{
	bool border = false;
	for (uint32_t left = 0, right; left < row->width; left = right) {
		right = left;
		while (right < row->width && contents_changed(row->contents, row->first_tile + right / TILE_WIDTH))
			right += TILE_WIDTH;
		right = right < row->width ? right : row->width;
		bool differs = left < right;
		if (differs) {
			convert_part(row, row->to + 4 * (size_t)left, left, right);
		} else {
			right = row->width - left < TILE_WIDTH ? row->width : left + TILE_WIDTH;
			differs = put_tile(row, left, right);
		}
		border |= differs && (row->outermost || left == 0 || right == row->width);
	}
	return border;
}

static void take_rows(struct engine *engine, enum picture_id id, uint32_t item)
{
	struct intake *intake = &cpu_of(engine)->intake;
	bool opaque = id == PICTURE_ORIGINAL;
	int index = opaque ? intake->color : intake->ui;
	const struct pursuit_plane *plane = &engine->job.frame->header.planes[index];
	const struct canvas *canvas = &cpu_of(engine)->pictures[id];
	struct row row = {.contents = &cpu_of(engine)->contents,
					  .convert = opaque ? &engine->color_convert : &engine->ui_convert,
					  .pixel_bytes = pixel_bytes(plane),
					  .width = plane->width,
					  .opaque = opaque};
	struct bounds bounds = {0};
	for (uint32_t y = item * ROWS_OF_ITEM; y < (item + 1) * ROWS_OF_ITEM && y < plane->height; y++) {
		if (opaque && !planes_changed(engine, y, 1))
			continue;
		row.from = engine->job.frame->planes[index] + (size_t)y * plane->stride;
		row.to = canvas_row(canvas, y);
		row.outermost = y == 0 || y + 1 == plane->height;
		row.first_tile = y / TILE_HEIGHT * row.contents->columns;
		const bool same = as_it_was(intake, opaque ? y : engine->height + y, row.from, plane);
		if (!same && put_row(&row) && opaque)
			canvas_close_row(canvas, y);
		if (!opaque)
			bounds_widen(&bounds, canvas_row(canvas, y), plane->width, y);
	}
	if (!opaque)
		intake->bounds[item] = bounds;
}

static void take(void *context, uint32_t item, uint32_t thread)
{
	struct intake *intake = context;
	item += intake->first_item;
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

static void plan_look(struct engine *engine, struct intake *intake)
{
	const size_t rows = 2 * (size_t)engine->height;
	const bool may = engine->damage.comparable && !engine->damage.known && engine->rested;
	intake->looks = may && intake->not_before == 0;
	intake->not_before -= intake->not_before > 0;
	if (intake->looks && rows > intake->hashes_capacity) {
		free(intake->hashes);
		intake->hashes = malloc(rows * sizeof(*intake->hashes));
		intake->hashes_capacity = intake->hashes ? rows : 0;
		intake->hashed = false;
	}
	if (intake->looks && !intake->hash_row)
		intake->hash_row = plan_level_kernels(plan_level_best())->hash_row;
	intake->looks &= intake->hashes != NULL;
	intake->compares = intake->looks && intake->hashed;
	intake->hashed = false;
	atomic_store(&intake->differs, false);
}

/* Blocks of rows up to the first that differs; the others are left to the pool. */
static uint32_t look_at_rows(struct intake *intake, uint32_t items)
{
	uint32_t item = 0;
	while (intake->compares && item < items && !atomic_load_explicit(&intake->differs, memory_order_relaxed))
		take(intake, item++, 0);
	return item;
}

/* All rows are there. */
static void conclude_look(struct engine *engine, struct intake *intake)
{
	const bool differs = atomic_load(&intake->differs);
	intake->hashed = intake->looks && !differs;
	if (differs)
		intake->not_before = LOOK_AGAIN_AFTER;
	if (!intake->compares || differs)
		return;
	planes_find_unchanged(engine);
	engine->report.bytes_up -= intake->bytes;
}

/* If there is none, nobody knows what is where. */
static int make_room(struct engine *engine, struct intake *intake, uint32_t items, struct error *error)
{
	struct executor_cpu *executor = cpu_of(engine);
	const bool ui = intake->ui >= 0;
	int result = canvas_resize(&executor->pictures[PICTURE_ORIGINAL], engine->width, engine->height, error);
	if (result == 0 && ui)
		result = canvas_resize(&executor->pictures[PICTURE_UI], engine->width, engine->height, error);
	if (result == 0)
		result = reserve(intake, items, error);
	if (result == 0)
		result = contents_begin(&executor->contents, engine->width, engine->height, ui, engine->content,
								executor->layers.shown == PICTURE_ORIGINAL, error);
	if (result < 0)
		executor->contents.known = false;
	return result;
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
	if (!planes_changed(engine, 0, engine->height)) {
		layers_clear(&executor->layers);
		report_leave_out(&engine->report, "upload", "unchanged");
		return 0;
	}
	result = make_room(engine, intake, items, error);
	layers_clear(&executor->layers);
	if (result < 0)
		return result;
	plan_look(engine, intake);
	intake->engine = engine;
	intake->color_items = items;
	intake->under_way = true;
	items = intake->ui >= 0 ? 2 * items : items;
	intake->first_item = 0;
	intake->first_item = look_at_rows(intake, items);
	pool_start(executor->base.pool, take, intake, items - intake->first_item);
	intake->bytes = 4 * (uint64_t)engine->width * engine->height * (intake->ui >= 0 ? 2 : 1);
	engine->report.bytes_up += intake->bytes;
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
	conclude_look(engine, &executor->intake);
}

static int analyse(struct engine *engine, struct error *error)
{
	const struct intake *intake = &cpu_of(engine)->intake;
	/* What is as it was rests, and needs no look at its motion. */
	if (intake->compares && !atomic_load(&intake->differs))
		cpu_finish_intake(engine);
	int result = pass_analyse.run(engine, error);
	cpu_finish_intake(engine);
	return result;
}

const struct pass cpu_pass_upload = {.run = run};
const struct pass cpu_pass_analyse = {.on_cpu = true, .run = analyse};
