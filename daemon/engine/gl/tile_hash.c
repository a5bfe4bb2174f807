/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/tile_hash.h"

#include <errno.h>
#include <string.h>
#include <sys/random.h>

#define PAIRS_OF_ROW (TILE_WIDTH / 2)
#define ROW_BYTES ((size_t)4 * TILE_WIDTH)

int tile_key_make(struct tile_key *key, struct error *error)
{
	uint8_t *to = (uint8_t *)key;
	for (size_t done = 0; done < sizeof(*key);) {
		const ssize_t count = getrandom(to + done, sizeof(*key) - done, 0);
		if (count < 0 && errno != EINTR)
			return error_set(error, -errno, "the system gives no random numbers: %s", strerror(errno));
		done += count > 0 ? (size_t)count : 0;
	}
	return 0;
}

/* A pixel and the one half a tile to the right of it are a pair, so that vectors of them lie side by side. */
static void add_row(const struct tile_key *key, uint32_t y, const uint8_t *pixels, struct tile_hash *tile)
{
	const uint32_t *left = key->left + y * PAIRS_OF_ROW, *right = key->right + y * PAIRS_OF_ROW;
	uint32_t row[TILE_WIDTH];
	uint64_t first = 0, second = 0;
	memcpy(row, pixels, sizeof(row));
	for (uint32_t i = 0; i < PAIRS_OF_ROW; i++) {
		const uint32_t a = row[i], b = row[i + PAIRS_OF_ROW];
		first += (uint64_t)(a + left[i]) * (b + right[i]);
		second += (uint64_t)(a + left[i + 1]) * (b + right[i + 1]);
	}
	tile->halves[0] += first;
	tile->halves[1] += second;
}

void tile_hash_row(const struct tile_key *key, uint32_t y, const uint8_t *pixels, uint32_t width,
				   struct tile_hash *tiles)
{
	for (; width >= TILE_WIDTH; width -= TILE_WIDTH, pixels += ROW_BYTES)
		add_row(key, y, pixels, tiles++);
	if (!width)
		return;
	uint8_t rest[ROW_BYTES] = {0};
	memcpy(rest, pixels, 4 * (size_t)width);
	add_row(key, y, rest, tiles);
}
