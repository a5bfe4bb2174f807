/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/soak/code.h"

static uint32_t color_of(uint32_t client, uint32_t frame, uint32_t x, uint32_t y)
{
	if (y == 0 && x < 2)
		return x == 0 ? client : frame;
	uint32_t hash = client * 0x9e3779b1u ^ frame * 0x85ebca6bu ^ (y * 16384 + x) * 0xc2b2ae35u;
	hash ^= hash >> 15;
	hash *= 0x2c1b3c6du;
	return (hash ^ hash >> 12) & 0xffffff;
}

void code_write(uint8_t *pixels, size_t stride, uint32_t width, uint32_t height, bool rgba, uint32_t client,
				uint32_t frame)
{
	for (uint32_t y = 0; y < height; y++)
		for (uint32_t x = 0; x < width; x++) {
			const uint32_t color = color_of(client, frame, x, y);
			uint8_t *to = pixels + y * stride + x * 4;
			to[rgba ? 2 : 0] = (uint8_t)color;
			to[1] = (uint8_t)(color >> 8);
			to[rgba ? 0 : 2] = (uint8_t)(color >> 16);
			to[3] = 255;
		}
}

static uint32_t load(const uint8_t *from)
{
	return (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16;
}

bool code_read(const uint8_t *pixels, size_t stride, uint32_t width, uint32_t height, uint32_t *client, uint32_t *frame)
{
	*client = load(pixels);
	*frame = load(pixels + 4);
	for (uint32_t y = 0; y < height; y++)
		for (uint32_t x = 0; x < width; x++)
			if (load(pixels + y * stride + x * 4) != color_of(*client, *frame, x, y))
				return false;
	return true;
}
