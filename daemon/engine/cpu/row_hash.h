/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A number of a row's bytes, to find rows that are as they were without keeping them. Each step maps words to numbers
 * one to one, so rows that differ in one word of 8 bytes never agree. Others do by chance, or if they are made to: a
 * difference in the topmost bit of a word goes through a step unchanged. Who does that deceives his own picture only.
 */
#ifndef PURSUIT_ENGINE_CPU_ROW_HASH_H
#define PURSUIT_ENGINE_CPU_ROW_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define ROW_HASH_FACTOR UINT64_C(0x9e3779b97f4a7c15)
#define ROW_HASH_LANES 8u

static inline uint64_t row_hash_step(uint64_t hash, uint64_t word)
{
	hash = (hash ^ word) * ROW_HASH_FACTOR;
	return hash ^ hash >> 32;
}

static inline uint64_t row_hash(const uint8_t *row, size_t bytes)
{
	uint64_t lanes[ROW_HASH_LANES] = {1, 2, 3, 4, 5, 6, 7, 8}, word, hash = bytes;
	const size_t step = sizeof(word) * ROW_HASH_LANES;
	uint8_t rest[sizeof(lanes)] = {0};
	size_t at = 0;
	for (; at + step <= bytes; at += step) {
		for (unsigned i = 0; i < ROW_HASH_LANES; i++) {
			memcpy(&word, row + at + i * sizeof(word), sizeof(word));
			lanes[i] = row_hash_step(lanes[i], word);
		}
	}
	memcpy(rest, row + at, bytes - at);
	for (unsigned i = 0; i < ROW_HASH_LANES; i++) {
		memcpy(&word, rest + i * sizeof(word), sizeof(word));
		hash = row_hash_step(hash, row_hash_step(lanes[i], word));
	}
	return hash;
}

#endif
