/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/contents.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

void contents_finish(struct contents *contents)
{
	free(contents->tiles);
	free(contents->layered);
	for (uint32_t i = 0; i < CONTENTS_IMAGES; i++)
		free(contents->images[i].tiles);
	*contents = (struct contents){0};
}

uint64_t contents_bytes(const struct contents *contents)
{
	return contents->capacity * ((CONTENTS_IMAGES + 1) * sizeof(*contents->tiles) + sizeof(*contents->layered));
}

static bool reserve(struct contents *contents, size_t count)
{
	if (count <= contents->capacity)
		return true;
	contents_finish(contents);
	contents->tiles = malloc(count * sizeof(*contents->tiles));
	contents->layered = malloc(count);
	bool good = contents->tiles && contents->layered;
	for (uint32_t i = 0; i < CONTENTS_IMAGES && good; i++) {
		contents->images[i].tiles = malloc(count * sizeof(*contents->tiles));
		good = contents->images[i].tiles != NULL;
	}
	contents->capacity = good ? count : 0;
	return good;
}

static int resize(struct contents *contents, uint32_t width, uint32_t height, struct error *error)
{
	if (contents->width == width && contents->height == height)
		return 0;
	const uint32_t columns = (width + TILE_WIDTH - 1) / TILE_WIDTH, rows = (height + TILE_HEIGHT - 1) / TILE_HEIGHT;
	contents->known = false;
	contents->width = contents->height = 0;
	for (uint32_t i = 0; i < CONTENTS_IMAGES; i++)
		contents->images[i].number = 0;
	if (!reserve(contents, (size_t)columns * rows))
		return error_set(error, -ENOMEM, "out of memory for the tiles of %u x %u pixels", width, height);
	contents->width = width;
	contents->height = height;
	contents->columns = columns;
	contents->rows = rows;
	return 0;
}

int contents_begin(struct contents *contents, uint32_t width, uint32_t height, bool ui, uint64_t now, bool original,
				   struct error *error)
{
	const int result = resize(contents, width, height, error);
	if (result < 0)
		return result;
	const bool all = !contents->known || contents->ui != ui;
	contents->now = now;
	for (size_t i = 0; i < (size_t)contents->columns * contents->rows && (all || !original); i++)
		if (all || contents->layered[i])
			contents->tiles[i] = now;
	contents->known = true;
	contents->ui = ui;
	return 0;
}

void contents_layer(struct contents *contents, const struct tiles *low, uint64_t real, uint64_t between)
{
	contents->real = real;
	contents->between = between;
	memset(contents->layered, 0, (size_t)contents->columns * contents->rows);
	for (uint32_t i = 0; i < low->columns * low->rows; i++) {
		const uint32_t x = i % low->columns * low->tile_width, y = i / low->columns * low->tile_height;
		if (low->marked[i])
			contents->layered[y / TILE_HEIGHT * contents->columns + x / TILE_WIDTH] = 1;
	}
}

static struct contents_image *find(struct contents *contents, uint64_t number)
{
	for (uint32_t i = 0; i < CONTENTS_IMAGES && number; i++)
		if (contents->images[i].number == number)
			return &contents->images[i];
	return NULL;
}

void contents_open(struct contents *contents, uint64_t held, struct sheet *sheet)
{
	struct contents_image *before = find(contents, held), *after = NULL;
	for (uint32_t i = 0; i < CONTENTS_IMAGES; i++) {
		struct contents_image *image = &contents->images[i];
		if (image != before && (!after || !image->number || (after->number && image->made < after->made)))
			after = image;
	}
	after->number = 0;
	/* Before the first frame there are none. */
	if (after->tiles)
		memset(after->tiles, 0, (size_t)contents->columns * contents->rows * sizeof(*after->tiles));
	sheet->before = before ? before->tiles : NULL;
	sheet->after = after->tiles;
}

static uint64_t count_kept(const struct contents *contents, const struct sheet *sheet)
{
	uint64_t pixels = 0;
	for (uint32_t tile = 0; tile < contents->columns * contents->rows && sheet->before; tile++) {
		const uint32_t left = tile % contents->columns * TILE_WIDTH, top = tile / contents->columns * TILE_HEIGHT;
		const uint32_t width = contents->width - left, height = contents->height - top;
		if (!sheet_is_fresh(sheet, tile))
			pixels += (width < TILE_WIDTH ? width : TILE_WIDTH) * (height < TILE_HEIGHT ? height : TILE_HEIGHT);
	}
	return pixels;
}

void contents_forget(struct contents *contents, uint64_t number)
{
	struct contents_image *image = find(contents, number);
	if (image)
		image->number = 0;
}

uint64_t contents_close(struct contents *contents, uint64_t number, const struct sheet *sheet)
{
	contents_forget(contents, number);
	for (uint32_t i = 0; i < CONTENTS_IMAGES; i++)
		if (contents->images[i].tiles == sheet->after) {
			contents->images[i].number = number;
			contents->images[i].made = ++contents->makes;
		}
	return count_kept(contents, sheet);
}
