/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Three pictures that differ only in some blocks (ORIGINAL, E and B): one canvas
 * that is one of them, and the blocks of the two others beside it, exchanged when
 * one of these is wanted.
 */
#ifndef PURSUIT_ENGINE_CPU_LAYERS_H
#define PURSUIT_ENGINE_CPU_LAYERS_H

#include "daemon/engine/cpu/canvas.h"
#include "daemon/engine/executor.h"
#include "daemon/engine/pool.h"
#include "daemon/engine/tiles.h"

/* Pixels a side. */
#define BLOCK_SIZE 8u
#define BLOCK_PIXELS (BLOCK_SIZE * BLOCK_SIZE)
#define BLOCK_BYTES (4u * BLOCK_PIXELS)

struct block {
	uint32_t x, y; /* pixels */
};

struct layers {
	struct block *blocks;
	uint32_t count, capacity;
	uint8_t *pixels[2];      /* BLOCK_BYTES a block, one after another */
	enum picture_id held[2]; /* what they are of */
	enum picture_id shown;   /* which of the three the canvas holds */
};

/* No blocks: all three are what the canvas holds. */
void layers_clear(struct layers *layers);
/* Memory that they hold. */
uint64_t layers_bytes(const struct layers *layers);
void layers_finish(struct layers *layers);

/*
 * The marked tiles, BLOCK_SIZE pixels a side, become blocks: pixels[0] of REAL, pixels[1] of BETWEEN, undefined as yet;
 * the canvas holds ORIGINAL. 0 or -ENOMEM with a sentence.
 */
int layers_begin(struct layers *layers, const struct tiles *tiles, struct error *error);

/* Makes the canvas hold one of the three; its border too. */
void layers_show(struct layers *layers, enum picture_id id, const struct canvas *canvas, struct pool *pool);

/* Copies a block out of a canvas; pixels beyond it repeat. */
void layers_take_block(const struct block *block, const struct canvas *canvas, uint8_t *pixels);

#endif
