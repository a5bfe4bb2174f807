/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Plain C for the base machine. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/cpu/levels.h"
#include "daemon/engine/cpu/pixel.h"

struct span;
static inline void put_span(int32_t *restrict x, int32_t *restrict y, const struct span *span);

static void sample_row(const struct canvas *canvas, const int32_t *x, const int32_t *y, uint32_t count, uint8_t *out)
{
	for (uint32_t i = 0; i < count; i++)
		pixel_sample(canvas, x[i], y[i], out + 4 * (size_t)i);
}

static void shift_row(const uint8_t *upper, const uint8_t *lower, uint32_t fx, uint32_t fy, uint32_t count,
					  uint8_t *out)
{
	for (size_t i = 0; i < 4 * (size_t)count; i++)
		out[i] = pixel_mix4(upper[i], upper[i + 4], lower[i], lower[i + 4], fx, fy);
}

static void mix_row(uint8_t *out, const uint8_t *low, const int16_t *tear, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		pixel_tear(out + 4 * (size_t)i, low + 4 * (size_t)i, tear[i]);
}

#include "daemon/engine/cpu/tile.h"

static inline void put_span(int32_t *restrict x, int32_t *restrict y, const struct span *span)
{
	for (uint32_t i = 0; i < span->count; i++) {
		x[i] = (int32_t)((uint32_t)span->x + i * (uint32_t)span->dx);
		y[i] = (int32_t)((uint32_t)span->y + i * (uint32_t)span->dy);
	}
}

#define LEVEL_KERNELS cpu_kernels_plain
#define LEVEL_NAME "plain"
#include "daemon/engine/cpu/kernels.h"
