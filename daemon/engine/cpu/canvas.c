/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/cpu/canvas.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define ALIGNMENT 64u
/* Bytes behind the last row that kernels may read, though not use. */
#define READ_BEYOND 256u
#define PIXELS_OF_ALIGNMENT (ALIGNMENT / 4u)

int canvas_resize(struct canvas *canvas, uint32_t width, uint32_t height, struct error *error)
{
	if (canvas->width == width && canvas->height == height)
		return 0;
	/* The border on the left takes a whole alignment. */
	size_t columns = PIXELS_OF_ALIGNMENT + ((size_t)width + CANVAS_BORDER + PIXELS_OF_ALIGNMENT - 1) /
											   PIXELS_OF_ALIGNMENT * PIXELS_OF_ALIGNMENT;
	size_t stride = 4 * columns, bytes = stride * ((size_t)height + 2 * CANVAS_BORDER) + ALIGNMENT + READ_BEYOND;
	bytes = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
	if (bytes > canvas->capacity) {
		canvas_finish(canvas);
		canvas->memory = aligned_alloc(ALIGNMENT, bytes);
		if (!canvas->memory)
			return error_set(error, -ENOMEM, "out of memory for a picture of %u x %u", width, height);
		canvas->capacity = bytes;
		memset(canvas->memory, 0, bytes);
	}
	canvas->width = width;
	canvas->height = height;
	canvas->stride = stride;
	canvas->pixels = (uint8_t *)canvas->memory + CANVAS_BORDER * stride + ALIGNMENT;
	return 0;
}

void canvas_finish(struct canvas *canvas)
{
	free(canvas->memory);
	*canvas = (struct canvas){0};
}

void canvas_close_row(const struct canvas *canvas, uint32_t y)
{
	uint8_t *row = canvas_row(canvas, y);
	for (uint32_t i = 0; i < CANVAS_BORDER; i++) {
		memcpy(row - 4 * (size_t)(i + 1), row, 4);
		memcpy(row + 4 * ((size_t)canvas->width + i), row + 4 * ((size_t)canvas->width - 1), 4);
	}
	const size_t whole = 4 * ((size_t)canvas->width + 2 * CANVAS_BORDER), left = 4 * (size_t)CANVAS_BORDER;
	for (uint32_t i = 1; i <= CANVAS_BORDER; i++) {
		if (y == 0)
			memcpy(canvas_row(canvas, -(int64_t)i) - left, row - left, whole);
		if (y + 1 == canvas->height)
			memcpy(canvas_row(canvas, (int64_t)y + i) - left, row - left, whole);
	}
}
