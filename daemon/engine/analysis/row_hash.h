/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A number of a row's bytes, to find rows that are as they were without keeping them. Each step maps words of 8 bytes
 * to numbers one to one, and so does the end, so rows that differ in one word never agree. Others do by chance, or if
 * they are made to: a difference in the topmost bit of a word goes through a step unchanged. Who does that deceives his
 * own picture only. Each level has lanes of its own width, and hence numbers of its own.
 *
 * Part of kernels.h. A level defines the vector type hash_lanes and, for it, hash_load(), from anywhere, and
 * hash_step(), which does to each word what values.h says.
 */
#ifndef PURSUIT_ANALYSIS_ROW_HASH_H
#define PURSUIT_ANALYSIS_ROW_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define HASH_VECTORS 8u
#define HASH_WORDS (sizeof(hash_lanes) / sizeof(uint64_t))

static inline void hash_block(hash_lanes *lanes, const uint8_t *bytes)
{
	for (size_t i = 0; i < HASH_VECTORS; i++)
		lanes[i] = hash_step(lanes[i], hash_load(bytes + i * sizeof(hash_lanes)));
}

static uint64_t hash_row(const uint8_t *row, size_t bytes)
{
	uint64_t words[HASH_VECTORS * HASH_WORDS], hash = bytes;
	hash_lanes lanes[HASH_VECTORS];
	const hash_lanes none = {0};
	uint8_t rest[sizeof(lanes)] = {0};
	size_t at = 0;
	for (size_t i = 0; i < HASH_VECTORS * HASH_WORDS; i++)
		words[i] = i + 1;
	memcpy(lanes, words, sizeof(lanes));
	for (; at + sizeof(lanes) <= bytes; at += sizeof(lanes))
		hash_block(lanes, row + at);
	if (at < bytes) {
		memcpy(rest, row + at, bytes - at);
		hash_block(lanes, rest);
	}
	/* One of the two takes another step before, or what differs alike in both would not count. */
	for (size_t half = HASH_VECTORS / 2; half > 0; half /= 2)
		for (size_t i = 0; i < half; i++)
			lanes[i] = hash_step(hash_step(lanes[i], none), lanes[i + half]);
	memcpy(words, lanes, sizeof(lanes[0]));
	for (size_t i = 0; i < HASH_WORDS; i++)
		hash = plan_hash_step(hash, words[i]);
	return hash;
}

#endif
