/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * 128 bits that stand for a tile's pixels, to find tiles that a texture holds already without keeping them. Two tiles
 * that differ have equal ones with a probability of 2^-64 at most, whatever is in them, over the choice of the key,
 * which is random and leaves the process nowhere: NH with 32-bit words, taken twice (Black, Halevi, Krawczyk, Krovetz,
 * Rogaway, "UMAC: Fast and Secure Message Authentication", CRYPTO 1999, Sections 4.1 to 4.3). Tiles are compared with
 * tiles of the same size only.
 */
#ifndef PURSUIT_ENGINE_GL_TILE_HASH_H
#define PURSUIT_ENGINE_GL_TILE_HASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/contents.h"
#include "daemon/error.h"

#define TILE_PAIRS (TILE_PIXELS / 2)

/* A pair of pixels has a key of its own, and for the second half of the hash that of the pair after it. */
struct tile_key {
	uint32_t left[TILE_PAIRS + 1], right[TILE_PAIRS + 1];
};

struct tile_hash {
	uint64_t halves[2];
};

/* 0, or a negative errno with a sentence: the system gives no random numbers. */
int tile_key_make(struct tile_key *key, struct error *error);

/* Adds a row of that many pixels, row y of its tiles, to each of the tiles beside each other; they start as zeros. */
void tile_hash_row(const struct tile_key *key, uint32_t y, const uint8_t *pixels, uint32_t width,
				   struct tile_hash *tiles);

static inline bool tile_hash_equal(const struct tile_hash *a, const struct tile_hash *b)
{
	return a->halves[0] == b->halves[0] && a->halves[1] == b->halves[1];
}

#endif
