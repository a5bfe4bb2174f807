/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What tiles show, by numbers, so that a tile is not written to an image that has it already. A tile's number stands
 * for its pixels in ORIGINAL with the UI over them and is never used for others, so that equal numbers mean equal
 * pixels; 0 means nothing. What images were left with is kept under the number that went out with each of them
 * (`holds` of struct engine_image): a number that is not found, since it is another's or too old, tells nothing.
 */
#ifndef PURSUIT_ENGINE_CONTENTS_H
#define PURSUIT_ENGINE_CONTENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/executor.h"
#include "daemon/engine/tiles.h"
#include "daemon/error.h"

/* Wide enough for long stores, small enough for the coordinates of a tile to stay in a core's first cache. */
#define TILE_WIDTH 64u
#define TILE_HEIGHT 32u
#define TILE_PIXELS (TILE_WIDTH * TILE_HEIGHT)

/* More than presenters have in turn. */
#define CONTENTS_IMAGES 16u

struct contents_image {
	uint64_t number; /* that went out with it; 0: it may be used for another */
	uint64_t made;   /* when, as struct contents counts; the oldest makes room */
	uint64_t *tiles;
};

struct contents {
	uint32_t width, height; /* of the picture */
	uint32_t columns, rows; /* tiles of TILE_WIDTH x TILE_HEIGHT */
	bool known;             /* `tiles` are what ORIGINAL shows; else the next frame is new as a whole */
	bool ui;                /* with a UI over it */
	uint64_t now;           /* of the tiles that differ in the frame begun last */
	uint64_t *tiles;        /* by tile of ORIGINAL, row by row */
	uint8_t *layered;       /* by tile: REAL and BETWEEN, if there are such, differ from ORIGINAL */
	uint64_t real, between; /* numbers of all such tiles of theirs, in the frame begun last */
	struct contents_image images[CONTENTS_IMAGES];
	uint64_t makes;
	size_t capacity; /* tiles */
};

/* An image that is being made: where, and by tile what was there before (NULL: unknown) and what is there now. */
struct sheet {
	uint8_t *data;
	size_t stride;
	const uint64_t *before;
	uint64_t *after;
};

void contents_finish(struct contents *contents);
/* Memory that they hold. */
uint64_t contents_bytes(const struct contents *contents);

/*
 * A frame of that size begins, whose tiles are `now` where they differ from what was. Before ORIGINAL is written to.
 * `original`: where it is kept nothing else is; else one of REAL and BETWEEN is, and tiles in which they differ are
 * `now`. 0, or -ENOMEM with a sentence; then nothing is known.
 */
int contents_begin(struct contents *contents, uint32_t width, uint32_t height, bool ui, uint64_t now, bool original,
				   struct error *error);

/* REAL and BETWEEN differ from ORIGINAL where `low` is marked, and nowhere else; two numbers never used. */
void contents_layer(struct contents *contents, const struct tiles *low, uint64_t real, uint64_t between);

/* The tile of ORIGINAL, or of the UI over it, is another than in the frame before. Any thread. */
static inline void contents_change(struct contents *contents, uint32_t tile)
{
	__atomic_store_n(&contents->tiles[tile], contents->now, __ATOMIC_RELAXED);
}

static inline bool contents_changed(const struct contents *contents, uint32_t tile)
{
	return __atomic_load_n(&contents->tiles[tile], __ATOMIC_RELAXED) == contents->now;
}

/* The number of a tile of a picture with the UI over it; 0: it has none. */
static inline uint64_t contents_of(const struct contents *contents, enum picture_id id, uint32_t tile)
{
	if (id != PICTURE_ORIGINAL && id != PICTURE_REAL && id != PICTURE_BETWEEN)
		return 0;
	if (id == PICTURE_ORIGINAL || !contents->layered[tile])
		return contents->tiles[tile];
	return id == PICTURE_REAL ? contents->real : contents->between;
}

/*
 * An image is made that was left with the number `held`, 0: unknown. Sets `before` and `after` (all 0) of the sheet,
 * which stay until the next but CONTENTS_IMAGES.
 */
void contents_open(struct contents *contents, uint64_t held, struct sheet *sheet);
/* It is done, and what it shows goes out under that number. Returns how many pixels were there before. */
uint64_t contents_close(struct contents *contents, uint64_t number, const struct sheet *sheet);

/* Nobody asks for an image of that number any more: there is room for another. */
void contents_forget(struct contents *contents, uint64_t number);

/* A tile that shows what the number stands for: is it there already? Else it has to be written. Any thread. */
static inline bool sheet_has(const struct sheet *sheet, uint32_t tile, uint64_t number)
{
	sheet->after[tile] = number;
	return number && sheet->before && sheet->before[tile] == number;
}

/* Whether the tile was written, or has to be. */
static inline bool sheet_is_fresh(const struct sheet *sheet, uint32_t tile)
{
	return !sheet->after[tile] || !sheet->before || sheet->before[tile] != sheet->after[tile];
}

#endif
