/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/cpu/layers.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define BLOCKS_OF_ITEM 128u

void layers_clear(struct layers *layers)
{
	layers->count = 0;
	layers->shown = PICTURE_ORIGINAL;
}

uint64_t layers_bytes(const struct layers *layers)
{
	return layers->capacity * (uint64_t)(sizeof(*layers->blocks) + 2 * BLOCK_BYTES);
}

void layers_finish(struct layers *layers)
{
	free(layers->blocks);
	free(layers->pixels[0]);
	free(layers->pixels[1]);
	*layers = (struct layers){0};
}

static bool reserve(struct layers *layers, uint32_t count, uint32_t most)
{
	if (count <= layers->capacity)
		return true;
	layers_finish(layers);
	/* Room to grow, so that it soon does not any more. */
	count = count + count / 2 < most ? count + count / 2 : most;
	layers->blocks = malloc(count * sizeof(*layers->blocks));
	layers->pixels[0] = malloc((size_t)count * BLOCK_BYTES);
	layers->pixels[1] = malloc((size_t)count * BLOCK_BYTES);
	if (!layers->blocks || !layers->pixels[0] || !layers->pixels[1])
		return false;
	layers->capacity = count;
	return true;
}

int layers_begin(struct layers *layers, const struct tiles *tiles, struct error *error)
{
	layers_clear(layers);
	if (!reserve(layers, tiles->count, tiles->columns * tiles->rows))
		return error_set(error, -ENOMEM, "out of memory for %u blocks of pixels", tiles->count);
	layers->held[0] = PICTURE_REAL;
	layers->held[1] = PICTURE_BETWEEN;
	for (uint32_t row = 0; row < tiles->rows; row++)
		for (uint32_t column = 0; column < tiles->columns; column++)
			if (tiles->marked[row * tiles->columns + column])
				layers->blocks[layers->count++] = (struct block){column * BLOCK_SIZE, row * BLOCK_SIZE};
	return 0;
}

void layers_take_block(const struct block *block, const struct canvas *canvas, uint8_t *pixels)
{
	uint32_t width = canvas->width - block->x < BLOCK_SIZE ? canvas->width - block->x : BLOCK_SIZE;
	for (uint32_t row = 0; row < BLOCK_SIZE; row++, pixels += 4 * BLOCK_SIZE) {
		uint32_t y = block->y + row < canvas->height ? block->y + row : canvas->height - 1;
		memcpy(pixels, canvas_row(canvas, y) + 4 * (size_t)block->x, 4 * (size_t)width);
		for (uint32_t i = width; i < BLOCK_SIZE; i++)
			memcpy(pixels + 4 * (size_t)i, pixels + 4 * ((size_t)width - 1), 4);
	}
}

static void exchange_block(const struct block *block, const struct canvas *canvas, uint8_t *pixels)
{
	const uint32_t left = canvas->width - block->x;
	const size_t bytes = 4 * (size_t)(left < BLOCK_SIZE ? left : BLOCK_SIZE);
	for (uint32_t row = 0; row < BLOCK_SIZE && block->y + row < canvas->height; row++, pixels += 4 * BLOCK_SIZE) {
		uint8_t *there = canvas_row(canvas, block->y + row) + 4 * (size_t)block->x, kept[4 * BLOCK_SIZE];
		memcpy(kept, there, bytes);
		memcpy(there, pixels, bytes);
		memcpy(pixels, kept, bytes);
	}
}

struct change {
	const struct layers *layers;
	const struct canvas *canvas;
	uint8_t *pixels;
};

static void exchange_blocks(void *context, uint32_t item, uint32_t thread)
{
	const struct change *change = context;
	uint32_t end = (item + 1) * BLOCKS_OF_ITEM;
	for (uint32_t i = item * BLOCKS_OF_ITEM; i < end && i < change->layers->count; i++)
		exchange_block(&change->layers->blocks[i], change->canvas, change->pixels + (size_t)i * BLOCK_BYTES);
}

/* The rows whose outermost pixels may have changed. */
static void close_border(const struct layers *layers, const struct canvas *canvas)
{
	bool outer = false;
	for (uint32_t i = 0; i < layers->count; i++) {
		const struct block *block = &layers->blocks[i];
		outer |= block->y == 0 || block->y + BLOCK_SIZE >= canvas->height;
		if (block->x != 0 && block->x + BLOCK_SIZE < canvas->width)
			continue;
		for (uint32_t row = 0; row < BLOCK_SIZE && block->y + row < canvas->height; row++)
			canvas_close_row(canvas, block->y + row);
	}
	if (!outer)
		return;
	canvas_close_row(canvas, 0);
	canvas_close_row(canvas, canvas->height - 1);
}

void layers_show(struct layers *layers, enum picture_id id, const struct canvas *canvas, struct pool *pool)
{
	if (layers->shown == id || !layers->count)
		return;
	const uint32_t place = layers->held[0] == id ? 0 : 1;
	struct change change = {layers, canvas, layers->pixels[place]};
	pool_run(pool, exchange_blocks, &change, (layers->count + BLOCKS_OF_ITEM - 1) / BLOCKS_OF_ITEM);
	close_border(layers, canvas);
	layers->held[place] = layers->shown;
	layers->shown = id;
}
