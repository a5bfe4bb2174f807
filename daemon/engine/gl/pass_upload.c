/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Colour and UI to the GPU, by blocks of rows that are first copied to private
 * memory: converted to the display's code values and made opaque on the way.
 */
#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/pass.h"

/* Where a row can be read after it was written: blocks on their way up may not. */
static int reserve_row(struct executor_gl *executor, size_t bytes, struct error *error)
{
	if (bytes <= executor->row_bytes)
		return 0;
	free(executor->row);
	executor->row = malloc(bytes);
	executor->row_bytes = executor->row ? bytes : 0;
	return executor->row ? 0 : error_set(error, -ENOMEM, "out of memory for a row of %zu bytes", bytes);
}

/* What is sent: a plane, converted. `bounds`: NULL for the opaque picture, else those of what is not transparent. */
struct layer {
	const struct convert *convert;
	const struct pursuit_plane *plane;
	const uint8_t *data;
	struct bounds *bounds;
};

static void fill(uint8_t *to, uint8_t *private, const struct layer *layer, uint32_t y, uint32_t rows)
{
	const uint32_t width = layer->plane->width;
	const size_t row_bytes = 4 * (size_t)width;
	for (uint32_t i = 0; i < rows; i++, to += row_bytes) {
		uint8_t *row = layer->bounds ? private : to;
		convert_row(layer->convert, row, layer->data + (y + i) * layer->plane->stride, width, !layer->bounds);
		if (!layer->bounds)
			continue;
		bounds_widen(layer->bounds, row, width, y + i);
		memcpy(to, row, row_bytes);
	}
}

static int send_rows(struct engine *engine, const struct layer *layer, uint32_t y, uint32_t rows, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	const size_t bytes = 4 * (size_t)layer->plane->width * rows;
	uint8_t *to = stream_begin(&executor->stream, gl, bytes, error);
	if (!to)
		return -ENOMEM;
	fill(to, executor->row, layer, y, rows);
	engine->report.bytes_up += bytes;
	const struct stream_target target = {(GLint)y, (GLsizei)layer->plane->width, (GLsizei)rows, gl->pixel_format,
										 gl->pixel_type};
	return stream_send(&executor->stream, gl, &target, error);
}

static int upload(struct engine *engine, enum picture_id id, const struct layer *layer, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const uint32_t width = layer->plane->width, height = layer->plane->height;
	const uint32_t block = stream_rows(4 * (size_t)width);
	int result = target_resize(picture_of(engine, id), gl, width, height, error);
	if (result == 0 && layer->bounds)
		result = reserve_row(gl_of(engine), 4 * (size_t)width, error);
	gl->ActiveTexture(GL_TEXTURE0);
	gl->BindTexture(GL_TEXTURE_2D, picture_of(engine, id)->texture);
	for (uint32_t y = 0; y < height && result == 0; y += block) {
		uint32_t rows = height - y < block ? height - y : block;
		if (layer->bounds || planes_changed(engine, y, rows))
			result = send_rows(engine, layer, y, rows, error);
	}
	return result;
}

static int run(struct engine *engine, struct error *error)
{
	const struct target *whole;
	int color, ui;
	int result = planes_prepare(engine, &color, &ui, error);
	if (result == 0 && engine->damage.known)
		result = gl_picture(engine, PICTURE_ORIGINAL, &whole, error);
	gl_layers_forget(&gl_of(engine)->layers);
	if (result == 0 && !planes_changed(engine, 0, engine->height)) {
		report_leave_out(&engine->report, "upload", "unchanged");
		return 0;
	}
	if (result < 0)
		return result;
	const struct frame *frame = engine->job.frame;
	const struct layer opaque = {&engine->color_convert, &frame->header.planes[color], frame->planes[color], NULL};
	result = upload(engine, PICTURE_ORIGINAL, &opaque, error);
	if (result < 0 || ui < 0)
		return result;
	const struct layer layer = {&engine->ui_convert, &frame->header.planes[ui], frame->planes[ui], &engine->ui_bounds};
	return upload(engine, PICTURE_UI, &layer, error);
}

const struct pass gl_pass_upload = {.run = run};
