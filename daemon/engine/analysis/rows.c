/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/analysis/rows.h"

#include <string.h>

typedef volatile uint16_t __attribute__((aligned(1), may_alias)) raw16;
typedef volatile uint32_t __attribute__((aligned(1), may_alias)) raw32;

void *plan_arena_take(struct plan_arena *arena, size_t bytes)
{
	void *piece = arena->base ? arena->base + arena->used : NULL;
	arena->used += (bytes + 63) / 64 * 64;
	return piece;
}

int plan_find_plane(const struct pursuit_frame_header *header, uint32_t role)
{
	for (uint32_t i = 0; i < header->plane_count && i < PURSUIT_MAX_PLANES; i++)
		if (header->planes[i].role == role)
			return (int)i;
	return -1;
}

static uint32_t nearest(uint32_t i, uint32_t of, uint32_t in)
{
	return (uint32_t)((2 * (uint64_t)i + 1) * in / (2 * (uint64_t)of));
}

static void map_columns(struct plan_rows *rows, struct plan_arena *arena)
{
	rows->columns = plan_arena_take(arena, rows->colour_width * sizeof(*rows->columns));
	rows->mapped = plan_arena_take(arena, (size_t)rows->colour_width * rows->pixel_bytes);
	if (!arena->base)
		return;
	for (uint32_t i = 0; i < rows->colour_width; i++)
		rows->columns[i] = nearest(i, rows->colour_width, rows->width);
}

void plan_rows_init(struct plan_rows *rows, const struct frame *frame, uint32_t role, struct plan_arena *arena)
{
	*rows = (struct plan_rows){.mapped_row = UINT32_MAX};
	int index = plan_find_plane(&frame->header, role), colour = plan_find_plane(&frame->header, PURSUIT_ROLE_COLOR);
	if (index < 0 || colour < 0 || !frame->planes[index])
		return;
	const struct pursuit_plane *plane = &frame->header.planes[index];
	rows->data = frame->planes[index];
	rows->stride = plane->stride;
	rows->pixel_bytes = pursuit_format_bytes(plane->format);
	rows->width = plane->width;
	rows->height = plane->height;
	rows->colour_width = frame->header.planes[colour].width;
	rows->colour_height = frame->header.planes[colour].height;
	rows->copies = frame->volatile_memory || ((uintptr_t)rows->data | rows->stride) % 4 != 0;
	if (rows->copies)
		rows->copy = plan_arena_take(arena, (size_t)rows->width * rows->pixel_bytes);
	if (rows->width != rows->colour_width)
		map_columns(rows, arena);
}

static uint32_t plane_row(const struct plan_rows *rows, uint32_t y)
{
	return rows->height == rows->colour_height ? y : nearest(y, rows->colour_height, rows->height);
}

const uint8_t *plan_rows_source(const struct plan_rows *rows, uint32_t y)
{
	return rows->data + plane_row(rows, y) * rows->stride;
}

static void gather(const struct plan_rows *rows, const uint8_t *row)
{
	size_t bytes = rows->pixel_bytes;
	for (uint32_t i = 0; i < rows->colour_width; i++)
		switch (bytes) {
		case 2:
			memcpy(rows->mapped + 2 * (size_t)i, row + 2 * (size_t)rows->columns[i], 2);
			break;
		case 4:
			memcpy(rows->mapped + 4 * (size_t)i, row + 4 * (size_t)rows->columns[i], 4);
			break;
		default:
			memcpy(rows->mapped + 8 * (size_t)i, row + 8 * (size_t)rows->columns[i], 8);
		}
}

const void *plan_rows_get(struct plan_rows *rows, uint32_t y)
{
	uint32_t at = plane_row(rows, y);
	const uint8_t *row = rows->data + at * rows->stride;
	const uint8_t *private = rows->copies ? rows->copy : row;
	if (at != rows->mapped_row) {
		if (rows->copies)
			memcpy(rows->copy, row, (size_t)rows->width * rows->pixel_bytes);
		if (rows->columns)
			gather(rows, private);
		rows->mapped_row = at;
	}
	return rows->columns ? rows->mapped : private;
}

static const uint8_t *pixel_at(const struct plan_rows *rows, uint32_t x, uint32_t y)
{
	size_t column = rows->columns ? rows->columns[x] : x;
	return plan_rows_source(rows, y) + column * rows->pixel_bytes;
}

uint32_t plan_rows_pixel(const struct plan_rows *rows, uint32_t x, uint32_t y)
{
	const void *pixel = pixel_at(rows, x, y);
	return rows->pixel_bytes == 2 ? *(const raw16 *)pixel : *(const raw32 *)pixel;
}

void plan_rows_expect(const struct plan_rows *rows, uint32_t x, uint32_t y)
{
	__builtin_prefetch(pixel_at(rows, x, y));
}

void plan_rows_expect_row(const struct plan_rows *rows, uint32_t y)
{
	if (!rows->data || y >= rows->colour_height)
		return;
	const uint8_t *row = plan_rows_source(rows, y);
	size_t bytes = (size_t)rows->width * rows->pixel_bytes;
	for (size_t i = 0; i < bytes; i += 64)
		__builtin_prefetch(row + i);
}
