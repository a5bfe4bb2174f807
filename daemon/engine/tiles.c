/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/tiles.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int tiles_begin(struct tiles *tiles, uint32_t width, uint32_t height, uint32_t tile_width, uint32_t tile_height,
				struct error *error)
{
	uint32_t columns = (width + tile_width - 1) / tile_width, rows = (height + tile_height - 1) / tile_height;
	if (columns * rows > tiles->capacity) {
		tiles_finish(tiles);
		tiles->marked = malloc((size_t)columns * rows);
		if (!tiles->marked)
			return error_set(error, -ENOMEM, "out of memory for the tiles of %u x %u pixels", width, height);
		tiles->capacity = columns * rows;
	}
	tiles->width = width;
	tiles->height = height;
	tiles->tile_width = tile_width;
	tiles->tile_height = tile_height;
	tiles->columns = columns;
	tiles->rows = rows;
	tiles->count = 0;
	memset(tiles->marked, 0, (size_t)columns * rows);
	return 0;
}

void tiles_finish(struct tiles *tiles)
{
	free(tiles->marked);
	*tiles = (struct tiles){0};
}

struct range {
	uint32_t first, end;
};

/* The tiles that an interval meets along one axis, its ends included. */
static struct range meet(float from, float to, uint32_t size, uint32_t count, uint32_t tile)
{
	if (!(to >= 0.0f) || !(from <= (float)size))
		return (struct range){0, 0};
	uint32_t first = from > 0.0f ? (uint32_t)from / tile : 0;
	uint32_t last = to < (float)size ? (uint32_t)to / tile : count - 1;
	return (struct range){first < count ? first : count - 1, (last < count ? last : count - 1) + 1};
}

void tiles_mark(struct tiles *tiles, struct box box)
{
	struct range x = meet(box.left, box.right, tiles->width, tiles->columns, tiles->tile_width);
	struct range y = meet(box.top, box.bottom, tiles->height, tiles->rows, tiles->tile_height);
	for (uint32_t j = y.first; j < y.end; j++)
		for (uint32_t i = x.first; i < x.end; i++) {
			uint8_t *tile = &tiles->marked[j * tiles->columns + i];
			if (!__atomic_load_n(tile, __ATOMIC_RELAXED))
				__atomic_store_n(tile, 1, __ATOMIC_RELAXED);
		}
}

void tiles_sum(struct tiles *tiles)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < tiles->columns * tiles->rows; i++)
		count += tiles->marked[i];
	tiles->count = count;
}

bool tiles_touch(const struct tiles *tiles, struct box box)
{
	struct range x = meet(box.left, box.right, tiles->width, tiles->columns, tiles->tile_width);
	struct range y = meet(box.top, box.bottom, tiles->height, tiles->rows, tiles->tile_height);
	for (uint32_t j = y.first; j < y.end; j++)
		for (uint32_t i = x.first; i < x.end; i++)
			if (tiles->marked[j * tiles->columns + i])
				return true;
	return false;
}

void tiles_mark_all(struct tiles *tiles)
{
	tiles->count = tiles->columns * tiles->rows;
	memset(tiles->marked, 1, tiles->count);
}

/* Where rows of tiles end that are marked alike. */
static uint32_t end_of_rows(const struct tiles *tiles, uint32_t row)
{
	const uint8_t *marked = tiles->marked + (size_t)row * tiles->columns;
	uint32_t end = row + 1;
	while (end < tiles->rows && memcmp(marked, tiles->marked + (size_t)end * tiles->columns, tiles->columns) == 0)
		end++;
	return end;
}

/* The next marked tiles of a row, from the column `range->end` on; false: there are no more. */
static bool next_range(const struct tiles *tiles, uint32_t row, uint32_t gap, struct range *range)
{
	const uint8_t *marked = tiles->marked + (size_t)row * tiles->columns;
	uint32_t column = range->end;
	while (column < tiles->columns && !marked[column])
		column++;
	range->first = range->end = column;
	for (; column < tiles->columns && column < range->end + gap; column++)
		if (marked[column])
			range->end = column + 1;
	return range->first < range->end;
}

static uint32_t clip(uint32_t tiles, uint32_t tile, uint32_t size)
{
	return tiles * tile < size ? tiles * tile : size;
}

bool tiles_next_bounds(const struct tiles *tiles, uint32_t gap, struct bounds *bounds)
{
	struct range range = {0, (bounds->right + tiles->tile_width - 1) / tiles->tile_width};
	for (uint32_t row = bounds->top / tiles->tile_height, end; row < tiles->rows; row = end, range.end = 0) {
		end = end_of_rows(tiles, row);
		if (!next_range(tiles, row, gap, &range))
			continue;
		*bounds = (struct bounds){range.first * tiles->tile_width, row * tiles->tile_height,
								  clip(range.end, tiles->tile_width, tiles->width),
								  clip(end, tiles->tile_height, tiles->height)};
		return true;
	}
	return false;
}

size_t tiles_most_numbers(const struct tiles *tiles)
{
	return 12 * (size_t)tiles->rows * ((tiles->columns + 1) / 2);
}

static uint16_t *write_rectangle(uint16_t *numbers, uint32_t left, uint32_t top, uint32_t right, uint32_t bottom)
{
	const uint16_t l = (uint16_t)left, t = (uint16_t)top, r = (uint16_t)right, b = (uint16_t)bottom;
	const uint16_t corners[12] = {l, t, r, t, l, b, l, b, r, t, r, b};
	memcpy(numbers, corners, sizeof(corners));
	return numbers + 12;
}

size_t tiles_write(const struct tiles *tiles, uint16_t *numbers)
{
	const uint32_t width = tiles->tile_width, height = tiles->tile_height;
	uint16_t *at = numbers;
	for (uint32_t j = 0; j < tiles->rows; j++)
		for (uint32_t i = 0; i < tiles->columns; i++) {
			const uint8_t *row = tiles->marked + j * tiles->columns;
			if (!row[i])
				continue;
			uint32_t first = i;
			while (i + 1 < tiles->columns && row[i + 1])
				i++;
			at = write_rectangle(at, width * first, height * j, width * (i + 1), height * (j + 1));
		}
	return (size_t)(at - numbers);
}
