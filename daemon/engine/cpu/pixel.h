/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The arithmetic of one pixel, which every level repeats to the bit: weights of
 * 8 bits whose sum is 255, so that a weight of one is exact, and one rounding.
 */
#ifndef PURSUIT_ENGINE_CPU_PIXEL_H
#define PURSUIT_ENGINE_CPU_PIXEL_H

#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/cpu/canvas.h"
#include "daemon/engine/cpu/scene.h"

/* What makes the sum of four weighted texels, 65025 at most and up to 3 too small, round to the nearest. */
#define PIXEL_HALF 130u

/* Bilinear: fx, fy 0 to 255 are the weights of the second column and of the second row. */
static inline uint8_t pixel_mix4(uint32_t p00, uint32_t p10, uint32_t p01, uint32_t p11, uint32_t fx, uint32_t fy)
{
	uint32_t upper = p00 * (255u - fx) + p10 * fx, lower = p01 * (255u - fx) + p11 * fx;
	uint32_t sum = (upper * ((255u - fy) * 257u) >> 16) + (lower * (fy * 257u) >> 16);
	return (uint8_t)((sum + PIXEL_HALF) * 257u >> 16);
}

static inline int32_t pixel_clamp(int32_t at, uint32_t size)
{
	const int32_t least = -32768, most = (int32_t)(size << 16) - 32768;
	at = at > least ? at : least;
	return at < most ? at : most;
}

static inline uint32_t pixel_weight(int32_t at)
{
	return (((uint32_t)at & 0xffffu) * 255u + 0x8000u) >> 16;
}

static inline void pixel_sample(const struct canvas *canvas, int32_t x, int32_t y, uint8_t *out)
{
	x = pixel_clamp(x, canvas->width);
	y = pixel_clamp(y, canvas->height);
	const uint8_t *upper = canvas_row(canvas, y >> 16) + 4 * (ptrdiff_t)(x >> 16), *lower = upper + canvas->stride;
	uint32_t fx = pixel_weight(x), fy = pixel_weight(y);
	for (int c = 0; c < 4; c++)
		out[c] = pixel_mix4(upper[c], upper[c + 4], lower[c], lower[c + 4], fx, fy);
}

static inline void pixel_tear(uint8_t *out, const uint8_t *low, int32_t tear)
{
	const int32_t one = 1 << TEAR_BITS;
	for (int c = 0; c < 4; c++)
		out[c] = (uint8_t)((out[c] * (one - tear) + low[c] * tear + one / 2) >> TEAR_BITS);
}

#endif
