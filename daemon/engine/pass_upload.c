/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Colour and UI to the GPU, by blocks of rows that are first copied to private
 * memory: converted to the display's code values and made opaque on the way.
 */
#include "daemon/engine/pass.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Small enough to stay in a core's cache between the copy and GL's own. */
#define BLOCK_BYTES (128u * 1024u)

static const char *prepare(struct engine *engine)
{
	return NULL;
}

static int find_plane(const struct pursuit_frame_header *header, uint32_t role)
{
	for (uint32_t i = 0; i < header->plane_count && i < PURSUIT_MAX_PLANES; i++)
		if (header->planes[i].role == role)
			return (int)i;
	return -1;
}

/* Widens the bounds by what is not transparent in a row of BGRA pixels. */
static void widen(struct bounds *bounds, const uint8_t *pixels, uint32_t width, uint32_t y)
{
	static const uint8_t nothing[4];
	uint32_t left = 0, right = width;
	while (left < right && memcmp(pixels + 4 * (size_t)left, nothing, 4) == 0)
		left++;
	if (left == right)
		return;
	while (memcmp(pixels + 4 * (size_t)(right - 1), nothing, 4) == 0)
		right--;
	bool first = bounds->left >= bounds->right;
	bounds->left = first || left < bounds->left ? left : bounds->left;
	bounds->right = first || right > bounds->right ? right : bounds->right;
	bounds->top = first ? y : bounds->top;
	bounds->bottom = y + 1;
}

static int reserve_staging(struct engine *engine, size_t bytes, struct error *error)
{
	if (bytes <= engine->staging_bytes)
		return 0;
	free(engine->staging);
	engine->staging = malloc(bytes);
	engine->staging_bytes = engine->staging ? bytes : 0;
	return engine->staging ? 0 : error_set(error, -ENOMEM, "out of memory for a block of rows of %zu bytes", bytes);
}

/* `bounds`: NULL for the opaque picture, else those of what is not transparent. */
static int upload(struct engine *engine, const struct target *target, const struct convert *convert,
				  const struct pursuit_plane *plane, const uint8_t *data, struct bounds *bounds, struct error *error)
{
	const struct gl *gl = engine_gl(engine);
	size_t row_bytes = 4 * (size_t)plane->width;
	uint32_t block = row_bytes < BLOCK_BYTES ? (uint32_t)(BLOCK_BYTES / row_bytes) : 1;
	block = block < plane->height ? block : plane->height;
	if (reserve_staging(engine, row_bytes * block, error) < 0)
		return -ENOMEM;
	gl->ActiveTexture(GL_TEXTURE0);
	gl->BindTexture(GL_TEXTURE_2D, target->texture);
	for (uint32_t y = 0; y < plane->height; y += block) {
		uint32_t rows = plane->height - y < block ? plane->height - y : block;
		for (uint32_t i = 0; i < rows; i++) {
			uint8_t *row = engine->staging + i * row_bytes;
			convert_row(convert, row, data + (size_t)(y + i) * plane->stride, plane->width, !bounds);
			if (bounds)
				widen(bounds, row, plane->width, y + i);
		}
		gl->TexSubImage2D(GL_TEXTURE_2D, 0, 0, (GLint)y, (GLsizei)plane->width, (GLsizei)rows, gl->pixel_format,
						  gl->pixel_type, engine->staging);
	}
	engine->report.bytes_up += row_bytes * plane->height;
	return 0;
}

static int upload_color(struct engine *engine, int index, struct error *error)
{
	const struct pursuit_plane *plane = &engine->job.frame->header.planes[index];
	int result = target_resize(&engine->color, engine_gl(engine), plane->width, plane->height, error);
	if (result < 0)
		return result;
	convert_prepare(&engine->color_convert, plane->format, &plane->transfer, engine->params.curve,
					engine->params.gamma);
	return upload(engine, &engine->color, &engine->color_convert, plane, engine->job.frame->planes[index], NULL, error);
}

static int upload_ui(struct engine *engine, int index, struct error *error)
{
	engine->ui_bounds = (struct bounds){0};
	if (index < 0)
		return 0;
	const struct pursuit_plane *plane = &engine->job.frame->header.planes[index];
	if (plane->width != engine->color.width || plane->height != engine->color.height)
		return error_set(error, -EINVAL, "the UI plane is %u x %u, must be as large as colour, %u x %u", plane->width,
						 plane->height, engine->color.width, engine->color.height);
	int result = target_resize(&engine->ui, engine_gl(engine), plane->width, plane->height, error);
	if (result < 0)
		return result;
	convert_prepare(&engine->ui_convert, plane->format, NULL, engine->params.curve, engine->params.gamma);
	return upload(engine, &engine->ui, &engine->ui_convert, plane, engine->job.frame->planes[index], &engine->ui_bounds,
				  error);
}

static int run(struct engine *engine, struct error *error)
{
	const struct frame *frame = engine->job.frame;
	int color = find_plane(&frame->header, PURSUIT_ROLE_COLOR);
	if (color < 0)
		return error_set(error, -EINVAL, "frame %llu has no colour plane", (unsigned long long)frame->header.frame_id);
	int result = upload_color(engine, color, error);
	return result < 0 ? result : upload_ui(engine, find_plane(&frame->header, PURSUIT_ROLE_UI), error);
}

const struct pass pass_upload = {.name = "upload", .prepare = prepare, .run = run};
