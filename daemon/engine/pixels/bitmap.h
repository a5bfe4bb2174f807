/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pictures in memory for methods that work pixel by pixel, whoever carries out the passes. BGRA8, rows from the top. */
#ifndef PURSUIT_PIXELS_BITMAP_H
#define PURSUIT_PIXELS_BITMAP_H

#include <math.h>
#include <stdint.h>

/* Owned by whoever made it; rows are packed. */
struct bitmap {
	uint32_t width, height;
	uint8_t *data; /* 4 x width x height bytes */
};

/* B G R in steps, 0 to 255. */
struct color {
	float c[3];
};

/* Bilinear at a finite position in pixels, centres at .5, clamped at the edge. */
static inline struct color bitmap_sample(const struct bitmap *bitmap, float x, float y)
{
	const float fx = fminf(fmaxf(x - 0.5f, 0.0f), (float)(bitmap->width - 1));
	const float fy = fminf(fmaxf(y - 0.5f, 0.0f), (float)(bitmap->height - 1));
	const uint32_t i = (uint32_t)fx, j = (uint32_t)fy;
	const float wx = fx - (float)i, wy = fy - (float)j;
	const uint8_t *a = bitmap->data + 4 * ((size_t)j * bitmap->width + i);
	const uint8_t *b = a + (i + 1 < bitmap->width ? 4 : 0);
	const size_t down = j + 1 < bitmap->height ? 4 * (size_t)bitmap->width : 0;
	struct color color;
	for (int c = 0; c < 3; c++) {
		const float upper = (float)a[c] + wx * (float)(b[c] - a[c]);
		const float lower = (float)a[down + c] + wx * (float)(b[down + c] - a[down + c]);
		color.c[c] = upper + wy * (lower - upper);
	}
	return color;
}

/* code8 of docs/method.md, 0, in steps. */
static inline void bitmap_put(uint8_t *pixel, const float color[3])
{
	for (int c = 0; c < 3; c++)
		pixel[c] = (uint8_t)(fminf(fmaxf(color[c], 0.0f), 255.0f) + 0.5f);
	pixel[3] = 255;
}

#endif
