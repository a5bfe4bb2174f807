/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/shown.h"

#include "daemon/engine/gl/executor_gl.h"

static int begin_tiles(struct gl_shown *shown, uint32_t width, uint32_t height, struct error *error)
{
	struct tiles *const all[] = {&shown->moving, &shown->copied, &shown->written};
	int result = 0;
	for (int i = 0; i < 3 && result == 0; i++)
		result = tiles_begin(all[i], width, height, TILE_WIDTH, TILE_HEIGHT, error);
	return result;
}

int gl_shown_begin(struct engine *engine, struct error *error)
{
	struct gl_shown *shown = &gl_of(engine)->shown;
	struct target *target = picture_of(engine, PICTURE_SHOWN);
	if (target->width != engine->width || target->height != engine->height || engine->params.leave_nothing_out)
		shown->number = 0;
	contents_open(&gl_of(engine)->contents, shown->number, &shown->sheet);
	shown->before = shown->number;
	shown->number = 0;
	shown->numbers = shown->sheet.after;
	int result = begin_tiles(shown, engine->width, engine->height, error);
	if (result == 0)
		result = gl_settle(engine, PICTURE_SHOWN, error);
	return result < 0 ? result : target_resize(target, table_of(engine), engine->width, engine->height, error);
}

void gl_shown_end(struct engine *engine)
{
	struct gl_shown *shown = &gl_of(engine)->shown;
	shown->number = engine_new_number(engine);
	contents_close(&gl_of(engine)->contents, shown->number, &shown->sheet);
	contents_forget(&gl_of(engine)->contents, shown->before);
}

void gl_shown_keep(struct engine *engine, enum picture_id id)
{
	struct gl_shown *shown = &gl_of(engine)->shown;
	const struct contents *contents = &gl_of(engine)->contents;
	for (uint32_t tile = 0; tile < contents->columns * contents->rows; tile++)
		if (!shown->moving.marked[tile] && !sheet_has(&shown->sheet, tile, contents_of(contents, id, tile)))
			shown->copied.marked[tile] = 1;
}

int gl_shown_copy(struct engine *engine, enum picture_id id, struct error *error)
{
	struct gl_shown *shown = &gl_of(engine)->shown;
	const struct target *picture;
	for (uint32_t tile = 0; tile < shown->copied.columns * shown->copied.rows; tile++) {
		shown->copied.marked[tile] &= !shown->moving.marked[tile];
		shown->written.marked[tile] = shown->copied.marked[tile] | shown->moving.marked[tile];
	}
	tiles_sum(&shown->copied);
	if (!shown->copied.count)
		return 0;
	int result = gl_picture(engine, id, &picture, error);
	if (result == 0)
		result = tile_buffer_load(&shown->rectangles, table_of(engine), &shown->copied, error);
	return result < 0 ? result
					  : gl_copy_tiles(engine, picture, picture_of(engine, PICTURE_SHOWN), &shown->rectangles, error);
}

int gl_settle(struct engine *engine, enum picture_id id, struct error *error)
{
	return readback_settle(&gl_of(engine)->readback, table_of(engine), picture_of(engine, id)->framebuffer, error);
}

int gl_open_image(struct engine *engine, struct sheet *sheet, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const enum picture_id id = engine->job.picture;
	const struct contents *contents = &executor->contents;
	struct tiles *leaving = &executor->leaving;
	int result = readback_settle(&executor->readback, table_of(engine), 0, error);
	if (result == 0)
		result = tiles_begin(leaving, engine->width, engine->height, TILE_WIDTH, TILE_HEIGHT, error);
	if (result < 0)
		return result;
	contents_open(&executor->contents, engine->params.leave_nothing_out ? 0 : engine->job.held, sheet);
	for (uint32_t tile = 0; tile < contents->columns * contents->rows; tile++) {
		const uint64_t number = id == PICTURE_SHOWN ? executor->shown.numbers[tile] : contents_of(contents, id, tile);
		leaving->marked[tile] = !sheet_has(sheet, tile, number);
	}
	return 0;
}

void gl_close_image(struct engine *engine, const struct sheet *sheet, uint64_t bytes)
{
	if (!engine->job.holds)
		engine->job.holds = engine_new_number(engine);
	contents_close(&gl_of(engine)->contents, engine->job.holds, sheet);
	engine->report.bytes_kept += 4 * (uint64_t)engine->width * engine->height - bytes;
}

void gl_shown_finish(struct gl_shown *shown, const struct gl *gl)
{
	tiles_finish(&shown->moving);
	tiles_finish(&shown->copied);
	tiles_finish(&shown->written);
	tile_buffer_finish(&shown->rectangles, gl);
}
