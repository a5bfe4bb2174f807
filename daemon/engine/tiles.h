/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A mask of equal tiles over a picture: where something has to be done. */
#ifndef PURSUIT_ENGINE_TILES_H
#define PURSUIT_ENGINE_TILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/bounds.h"
#include "daemon/error.h"

struct tiles {
	uint32_t width, height;           /* of the picture, pixels */
	uint32_t tile_width, tile_height; /* pixels */
	uint32_t columns, rows;
	uint8_t *marked;
	uint32_t capacity;
	uint32_t count; /* marked; after tiles_sum() */
};

/* The smallest rectangle around something, pixels. */
struct box {
	float left, top, right, bottom;
};

/* All unmarked. 0, or -ENOMEM with a sentence. */
int tiles_begin(struct tiles *tiles, uint32_t width, uint32_t height, uint32_t tile_width, uint32_t tile_height,
				struct error *error);
void tiles_finish(struct tiles *tiles);

/* Several threads may mark at a time. */
void tiles_mark(struct tiles *tiles, struct box box);
/* Counts the marked ones. */
void tiles_sum(struct tiles *tiles);

/* Whether any of those that the box meets is marked. */
bool tiles_touch(const struct tiles *tiles, struct box box);

/* Marks everything. */
void tiles_mark_all(struct tiles *tiles);

/*
 * The next of the rectangles of pixels that cover the marked tiles, none twice; the first after a zeroed one. Tiles
 * between marked ones of a row that are fewer than `gap`, at least 1, go along. False: there are no more.
 */
bool tiles_next_bounds(const struct tiles *tiles, uint32_t gap, struct bounds *bounds);

/*
 * Writes the marked tiles as triangles, 12 numbers (x, y of 6 corners, pixels) a row of neighbours; returns how many
 * numbers. `numbers` has room for tiles_most_numbers().
 */
size_t tiles_write(const struct tiles *tiles, uint16_t *numbers);
size_t tiles_most_numbers(const struct tiles *tiles);

#endif
