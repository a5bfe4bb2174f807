/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A mask of square tiles over a picture: where something has to be done. */
#ifndef PURSUIT_ENGINE_TILES_H
#define PURSUIT_ENGINE_TILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct tiles {
	uint32_t width, height; /* of the picture, pixels */
	uint32_t tile;          /* pixels a side */
	uint32_t columns, rows;
	uint8_t *marked;
	uint32_t capacity;
	uint32_t count; /* marked; after tiles_sum() */
};

/* The smallest rectangle around something, pixels. */
struct box {
	float left, top, right, bottom;
};

/* All unmarked. False if memory is out. */
bool tiles_begin(struct tiles *tiles, uint32_t width, uint32_t height, uint32_t tile);
void tiles_finish(struct tiles *tiles);
/* The same tiles, the same marked. False if memory is out. */
bool tiles_copy(struct tiles *to, const struct tiles *from);

/* Several threads may mark at a time. */
void tiles_mark(struct tiles *tiles, struct box box);
/* Counts the marked ones. */
void tiles_sum(struct tiles *tiles);

bool tiles_touch(const struct tiles *tiles, struct box box);

/* Marks everything. */
void tiles_mark_all(struct tiles *tiles);
/*
 * Writes the marked tiles as triangles, 12 numbers (x, y of 6 corners, pixels) a row of neighbours; returns how many
 * numbers. `numbers` has room for tiles_most_numbers().
 */
size_t tiles_write(const struct tiles *tiles, float *numbers);
size_t tiles_most_numbers(const struct tiles *tiles);

#endif
