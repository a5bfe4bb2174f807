/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Colour and UI to the GPU, by rows of tiles that are first copied to private memory: converted to the display's code
 * values and made opaque on the way. Tiles that the textures hold already are not sent; if after a frame that did not
 * move none is, the picture is what it was.
 */
#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/pass.h"

#define MOST_TILES ((PURSUIT_MAX_SIZE + TILE_WIDTH - 1) / TILE_WIDTH)

/* Rectangles of a row of tiles. */
#define MOST_CALLS ((MOST_TILES + GL_TILES_OF_CALL) / (GL_TILES_OF_CALL + 1))

/* What is sent: a plane, converted. */
struct layer {
	enum picture_id id;
	const struct convert *convert;
	const struct pursuit_plane *plane;
	const uint8_t *data;
	struct bounds *bounds; /* of what is not transparent; NULL for the opaque picture */
	struct tile_hash *hashes;
	bool *hashed;
	bool differs; /* some of it was sent */
};

/* A row of tiles on its way. */
struct tile_row {
	uint32_t y, rows;      /* pixels of the picture */
	uint32_t first, count; /* tiles */
	struct stream_target targets[MOST_CALLS];
	uint32_t target_count;
	size_t bytes;
};

static int reserve_hashes(struct gl_intake *intake, size_t tiles, struct error *error)
{
	if (tiles <= intake->tiles)
		return 0;
	intake->tiles = 0;
	for (int i = 0; i < 2; i++) {
		free(intake->hashes[i]);
		intake->hashes[i] = malloc(tiles * sizeof(*intake->hashes[i]));
	}
	if (!intake->hashes[0] || !intake->hashes[1])
		return error_set(error, -ENOMEM, "out of memory for %zu tiles", tiles);
	intake->tiles = tiles;
	return 0;
}

static int reserve_rows(struct gl_intake *intake, size_t row_bytes, struct error *error)
{
	if (row_bytes <= intake->row_bytes)
		return 0;
	free(intake->rows);
	intake->rows = malloc(TILE_HEIGHT * row_bytes);
	intake->row_bytes = intake->rows ? row_bytes : 0;
	return intake->rows ? 0 : error_set(error, -ENOMEM, "out of memory for rows of %zu bytes", row_bytes);
}

/* Takes a row of tiles, each pixel once. */
static void take(const struct gl_intake *intake, const struct layer *layer, const struct tile_row *row,
				 struct tile_hash *hashes)
{
	const uint32_t width = layer->plane->width;
	memset(hashes, 0, row->count * sizeof(*hashes));
	for (uint32_t i = 0; i < row->rows; i++) {
		uint8_t *to = intake->rows + 4 * (size_t)width * i;
		convert_row(layer->convert, to, layer->data + (row->y + i) * layer->plane->stride, width, !layer->bounds);
		tile_hash_row(&intake->key, i, to, width, hashes);
		if (layer->bounds)
			bounds_widen(layer->bounds, to, width, row->y + i);
	}
}

/* Marks what has to be sent; how many tiles. */
static uint32_t find_changed(struct engine *engine, const struct layer *layer, const struct tile_row *row,
							 const struct tile_hash *hashes)
{
	struct contents *contents = &gl_of(engine)->contents;
	struct tiles *sent = &gl_of(engine)->intake.sent;
	for (uint32_t i = 0; i < row->count; i++) {
		struct tile_hash *known = &layer->hashes[row->first + i];
		const bool forced = !*layer->hashed || (!layer->bounds && contents_changed(contents, row->first + i));
		if (!forced && tile_hash_equal(known, &hashes[i]))
			continue;
		*known = hashes[i];
		contents_change(contents, row->first + i);
		sent->marked[i] = 1;
	}
	tiles_sum(sent);
	return sent->count;
}

static void find_targets(const struct engine *engine, struct tile_row *row)
{
	const struct gl *gl = table_of(engine);
	struct bounds bounds = {0};
	while (tiles_next_bounds(&gl_of(engine)->intake.sent, GL_TILES_OF_CALL, &bounds)) {
		const uint32_t width = bounds.right - bounds.left;
		row->targets[row->target_count++] = (struct stream_target){.x = (GLint)bounds.left,
																   .y = (GLint)row->y,
																   .width = (GLsizei)width,
																   .rows = (GLsizei)row->rows,
																   .format = gl->pixel_format,
																   .type = gl->pixel_type,
																   .offset = row->bytes};
		row->bytes += 4 * (size_t)width * row->rows;
	}
}

static int send(struct engine *engine, struct layer *layer, const struct tile_row *row, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	uint8_t *to = stream_begin(&executor->stream, gl, row->bytes, error);
	if (!to)
		return -ENOMEM;
	for (uint32_t i = 0; i < row->target_count; i++) {
		const struct stream_target *target = &row->targets[i];
		const size_t bytes = 4 * (size_t)target->width;
		for (uint32_t y = 0; y < row->rows; y++, to += bytes)
			memcpy(to, executor->intake.rows + 4 * ((size_t)y * layer->plane->width + (size_t)target->x), bytes);
	}
	engine->report.bytes_up += row->bytes;
	layer->differs = true;
	return stream_send(&executor->stream, gl, row->targets, row->target_count, error);
}

static int upload_row(struct engine *engine, struct layer *layer, uint32_t index, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	struct tile_hash hashes[MOST_TILES];
	struct tile_row row = {.y = index * TILE_HEIGHT, .count = executor->contents.columns};
	row.rows = engine->height - row.y < TILE_HEIGHT ? engine->height - row.y : TILE_HEIGHT;
	row.first = index * row.count;
	if (!layer->bounds && !planes_changed(engine, row.y, row.rows))
		return 0;
	const int result = tiles_begin(&executor->intake.sent, engine->width, row.rows, TILE_WIDTH, TILE_HEIGHT, error);
	if (result < 0)
		return result;
	take(&executor->intake, layer, &row, hashes);
	if (!find_changed(engine, layer, &row, hashes))
		return 0;
	find_targets(engine, &row);
	return send(engine, layer, &row, error);
}

static int upload(struct engine *engine, struct layer *layer, struct error *error)
{
	const struct gl *gl = table_of(engine);
	int result = target_resize(picture_of(engine, layer->id), gl, engine->width, engine->height, error);
	gl->ActiveTexture(GL_TEXTURE0);
	gl->BindTexture(GL_TEXTURE_2D, picture_of(engine, layer->id)->texture);
	for (uint32_t i = 0; i < gl_of(engine)->contents.rows && result == 0; i++)
		result = upload_row(engine, layer, i, error);
	*layer->hashed = result == 0;
	return result;
}

/* Nothing differs from a frame that did not move: it rests. */
static void conclude_look(struct engine *engine)
{
	if (engine->damage.comparable && !engine->damage.known && engine->rested)
		planes_find_unchanged(engine);
}

static struct layer layer_of(struct engine *engine, enum picture_id id, int index)
{
	const struct frame *frame = engine->job.frame;
	const bool opaque = id == PICTURE_ORIGINAL;
	struct gl_intake *intake = &gl_of(engine)->intake;
	return (struct layer){.id = id,
						  .convert = opaque ? &engine->color_convert : &engine->ui_convert,
						  .plane = &frame->header.planes[index],
						  .data = frame->planes[index],
						  .bounds = opaque ? NULL : &engine->ui_bounds,
						  .hashes = intake->hashes[!opaque],
						  .hashed = &intake->hashed[!opaque]};
}

static int make_room(struct engine *engine, bool ui, bool original, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	struct contents *contents = &executor->contents;
	struct gl_intake *intake = &executor->intake;
	const bool same = contents->width == engine->width && contents->height == engine->height;
	intake->hashed[0] &= same;
	intake->hashed[1] &= same && ui && contents->ui;
	int result = contents_begin(contents, engine->width, engine->height, ui, engine->content, original, error);
	if (result == 0)
		result = reserve_hashes(intake, (size_t)contents->columns * contents->rows, error);
	return result == 0 ? reserve_rows(intake, 4 * (size_t)engine->width, error) : result;
}

/* `original`: the texture of ORIGINAL holds nothing else. */
static int take_planes(struct engine *engine, int color, int ui, bool original, struct error *error)
{
	int result = make_room(engine, ui >= 0, original, error);
	if (result == 0)
		result = gl_settle(engine, PICTURE_ORIGINAL, error);
	if (result < 0)
		return result;
	struct layer opaque = layer_of(engine, PICTURE_ORIGINAL, color), layer = {.differs = false};
	result = upload(engine, &opaque, error);
	if (result == 0 && ui >= 0) {
		layer = layer_of(engine, PICTURE_UI, ui);
		result = upload(engine, &layer, error);
	}
	if (result == 0 && !opaque.differs && !layer.differs)
		conclude_look(engine);
	return result;
}

static int run(struct engine *engine, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct target *whole;
	int color, ui;
	int result = planes_prepare(engine, &color, &ui, error);
	if (result == 0 && engine->damage.known)
		result = gl_picture(engine, PICTURE_ORIGINAL, &whole, error);
	const bool original = executor->layers.shown == PICTURE_ORIGINAL;
	gl_layers_forget(&executor->layers);
	if (result == 0 && !planes_changed(engine, 0, engine->height)) {
		report_leave_out(&engine->report, "upload", "unchanged");
		return 0;
	}
	if (result == 0)
		result = take_planes(engine, color, ui, original, error);
	if (result < 0)
		executor->contents.known = executor->intake.hashed[0] = executor->intake.hashed[1] = false;
	return result;
}

const struct pass gl_pass_upload = {.run = run};
