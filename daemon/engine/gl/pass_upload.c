/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Colour and UI to the GPU, by blocks of rows that are first copied to private
 * memory: converted to the display's code values and made opaque on the way.
 */
#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>
#include <stdlib.h>

#include "daemon/engine/pass.h"

/* Small enough to stay in a core's cache between the copy and GL's own. */
#define BLOCK_BYTES (128u * 1024u)

static int reserve_staging(struct executor_gl *executor, size_t bytes, struct error *error)
{
	if (bytes <= executor->staging_bytes)
		return 0;
	free(executor->staging);
	executor->staging = malloc(bytes);
	executor->staging_bytes = executor->staging ? bytes : 0;
	return executor->staging ? 0 : error_set(error, -ENOMEM, "out of memory for a block of rows of %zu bytes", bytes);
}

/* `bounds`: NULL for the opaque picture, else those of what is not transparent. */
static int upload(struct engine *engine, enum picture_id id, const struct convert *convert, int index,
				  struct bounds *bounds, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	const struct pursuit_plane *plane = &engine->job.frame->header.planes[index];
	const uint8_t *data = engine->job.frame->planes[index];
	size_t row_bytes = 4 * (size_t)plane->width;
	uint32_t block = row_bytes < BLOCK_BYTES ? (uint32_t)(BLOCK_BYTES / row_bytes) : 1;
	block = block < plane->height ? block : plane->height;
	int result = target_resize(picture_of(engine, id), gl, plane->width, plane->height, error);
	if (result == 0)
		result = reserve_staging(executor, row_bytes * block, error);
	if (result < 0)
		return result;
	gl->ActiveTexture(GL_TEXTURE0);
	gl->BindTexture(GL_TEXTURE_2D, picture_of(engine, id)->texture);
	for (uint32_t y = 0; y < plane->height; y += block) {
		uint32_t rows = plane->height - y < block ? plane->height - y : block;
		if (!bounds && !planes_changed(engine, y, rows))
			continue;
		for (uint32_t i = 0; i < rows; i++) {
			uint8_t *row = executor->staging + i * row_bytes;
			convert_row(convert, row, data + (size_t)(y + i) * plane->stride, plane->width, !bounds);
			if (bounds)
				bounds_widen(bounds, row, plane->width, y + i);
		}
		gl->TexSubImage2D(GL_TEXTURE_2D, 0, 0, (GLint)y, (GLsizei)plane->width, (GLsizei)rows, gl->pixel_format,
						  gl->pixel_type, executor->staging);
		engine->report.bytes_up += row_bytes * rows;
	}
	return 0;
}

static int run(struct engine *engine, struct error *error)
{
	int color, ui;
	int result = planes_prepare(engine, &color, &ui, error);
	if (result == 0 && !planes_changed(engine, 0, engine->height)) {
		report_leave_out(&engine->report, "upload", "unchanged");
		return 0;
	}
	if (result == 0)
		result = upload(engine, PICTURE_ORIGINAL, &engine->color_convert, color, NULL, error);
	if (result == 0 && ui >= 0)
		result = upload(engine, PICTURE_UI, &engine->ui_convert, ui, &engine->ui_bounds, error);
	return result;
}

const struct pass gl_pass_upload = {.run = run};
