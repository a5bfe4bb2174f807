/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pixels/inverse_filter.h"

#include <string.h>

#define MOST_SAMPLES 16.0f

static void sharpen(const struct bitmap *from, uint32_t i, uint32_t j, float ux, float uy, uint8_t *pixel)
{
	const uint8_t *own = from->data + 4 * ((size_t)j * from->width + i);
	const float length = sqrtf(ux * ux + uy * uy);
	const float count = fminf(fmaxf(ceilf(length), 1.0f), MOST_SAMPLES);
	float sum[3] = {0.0f, 0.0f, 0.0f}, sharp[3];
	for (int k = 0; k < (int)count; k++) {
		const float s = ((float)k + 0.5f) / count - 0.5f;
		const struct color color = bitmap_sample(from, (float)i + 0.5f + s * ux, (float)j + 0.5f + s * uy);
		for (int c = 0; c < 3; c++)
			sum[c] += color.c[c];
	}
	for (int c = 0; c < 3; c++)
		sharp[c] = 2.0f * (float)own[c] - sum[c] / count;
	bitmap_put(pixel, sharp);
}

void inverse_filter(const struct plan_dense *dense, const struct bitmap *from, struct bitmap *to)
{
	size_t at = 0;
	memcpy(to->data, from->data, 4 * (size_t)from->width * from->height);
	for (uint32_t j = 0; j < from->height; j++)
		for (uint32_t i = 0; i < from->width; i++, at++)
			if (dense->ux[at] != 0.0f || dense->uy[at] != 0.0f)
				sharpen(from, i, j, dense->ux[at], dense->uy[at], to->data + 4 * at);
}
