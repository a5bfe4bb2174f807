/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <arm_neon.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/cpu/levels.h"
#include "daemon/engine/cpu/pixel.h"

struct span;
static inline void put_span(int32_t *restrict x, int32_t *restrict y, const struct span *span);

/* The upper halves of the products. */
static inline uint16x8_t multiply_high(uint16x8_t a, uint16x8_t b)
{
	uint32x4_t low = vmull_u16(vget_low_u16(a), vget_low_u16(b)), high = vmull_high_u16(a, b);
	return vuzp2q_u16(vreinterpretq_u16_u32(low), vreinterpretq_u16_u32(high));
}

/* Two pixels and their neighbours, mixed by the neighbours' weights: words of 16 bits. */
static inline uint16x8_t mix_neighbours(uint8x8_t here, uint8x8_t next, uint8x8_t across)
{
	return vmlal_u8(vmull_u8(here, vmvn_u8(across)), next, across);
}

/* Two rows of such words by weights of the lower one, times 257; to bytes. */
static inline uint8x8_t mix_rows(uint16x8_t upper, uint16x8_t lower, uint16x8_t down)
{
	uint16x8_t sum = vaddq_u16(multiply_high(upper, vmvnq_u16(down)), multiply_high(lower, down));
	sum = vaddq_u16(sum, vdupq_n_u16(PIXEL_HALF));
	return vmovn_u16(multiply_high(sum, vdupq_n_u16(257)));
}

static inline int32x4_t clamped(int32x4_t at, uint32_t size)
{
	at = vmaxq_s32(at, vdupq_n_s32(-32768));
	return vminq_s32(at, vdupq_n_s32((int32_t)(size << 16) - 32768));
}

/* Weights of the second texel, in each byte of a lane. */
static inline uint8x16_t weights_of(int32x4_t at)
{
	uint32x4_t fraction = vandq_u32(vreinterpretq_u32_s32(at), vdupq_n_u32(0xffff));
	uint32x4_t scaled = vsubq_u32(vshlq_n_u32(fraction, 8), fraction);
	uint32x4_t weights = vshrq_n_u32(vaddq_u32(scaled, vdupq_n_u32(0x8000)), 16);
	return vreinterpretq_u8_u32(vmulq_n_u32(weights, 0x01010101u));
}

/* Two samples from their upper left texels. */
static inline uint8x8_t sample_2(const uint8_t *first, const uint8_t *second, size_t stride, uint8x8_t across,
								 uint8x8_t down)
{
	uint32x2_t a = vreinterpret_u32_u8(vld1_u8(first)), b = vreinterpret_u32_u8(vld1_u8(second));
	uint32x2_t c = vreinterpret_u32_u8(vld1_u8(first + stride)), d = vreinterpret_u32_u8(vld1_u8(second + stride));
	uint16x8_t upper =
		mix_neighbours(vreinterpret_u8_u32(vzip1_u32(a, b)), vreinterpret_u8_u32(vzip2_u32(a, b)), across);
	uint16x8_t lower =
		mix_neighbours(vreinterpret_u8_u32(vzip1_u32(c, d)), vreinterpret_u8_u32(vzip2_u32(c, d)), across);
	return mix_rows(upper, lower, vmulq_n_u16(vmovl_u8(down), 257));
}

static inline const uint8_t *texel(const struct canvas *canvas, int32_t x, int32_t y)
{
	return canvas_row(canvas, y) + 4 * (ptrdiff_t)x;
}

static void sample_row(const struct canvas *canvas, const int32_t *x, const int32_t *y, uint32_t count, uint8_t *out)
{
	uint32_t i = 0;
	for (; i + 4 <= count; i += 4) {
		int32x4_t u = clamped(vld1q_s32(x + i), canvas->width), v = clamped(vld1q_s32(y + i), canvas->height);
		uint8x16_t across = weights_of(u), down = weights_of(v);
		int32x4_t left = vshrq_n_s32(u, 16), top = vshrq_n_s32(v, 16);
		uint8x8_t first = sample_2(texel(canvas, vgetq_lane_s32(left, 0), vgetq_lane_s32(top, 0)),
								   texel(canvas, vgetq_lane_s32(left, 1), vgetq_lane_s32(top, 1)), canvas->stride,
								   vget_low_u8(across), vget_low_u8(down));
		uint8x8_t second = sample_2(texel(canvas, vgetq_lane_s32(left, 2), vgetq_lane_s32(top, 2)),
									texel(canvas, vgetq_lane_s32(left, 3), vgetq_lane_s32(top, 3)), canvas->stride,
									vget_high_u8(across), vget_high_u8(down));
		vst1q_u8(out + 4 * (size_t)i, vcombine_u8(first, second));
	}
	for (; i < count; i++)
		pixel_sample(canvas, x[i], y[i], out + 4 * (size_t)i);
}

static void shift_row(const uint8_t *upper, const uint8_t *lower, uint32_t fx, uint32_t fy, uint32_t count,
					  uint8_t *out)
{
	const uint8x8_t across = vdup_n_u8((uint8_t)fx);
	const uint16x8_t down = vdupq_n_u16((uint16_t)(fy * 257));
	uint32_t bytes = 4 * count, i = 0;
	for (; i + 8 <= bytes; i += 8) {
		uint16x8_t above = mix_neighbours(vld1_u8(upper + i), vld1_u8(upper + i + 4), across);
		uint16x8_t below = mix_neighbours(vld1_u8(lower + i), vld1_u8(lower + i + 4), across);
		vst1_u8(out + i, mix_rows(above, below, down));
	}
	for (; i < bytes; i++)
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
	static const int32_t lanes[4] = {0, 1, 2, 3};
	const uint32x4_t index = vreinterpretq_u32_s32(vld1q_s32(lanes));
	uint32x4_t u = vmlaq_n_u32(vdupq_n_u32((uint32_t)span->x), index, (uint32_t)span->dx);
	uint32x4_t v = vmlaq_n_u32(vdupq_n_u32((uint32_t)span->y), index, (uint32_t)span->dy);
	const uint32x4_t dx = vdupq_n_u32(4 * (uint32_t)span->dx), dy = vdupq_n_u32(4 * (uint32_t)span->dy);
	uint32_t i = 0;
	for (; i + 4 <= span->count; i += 4) {
		vst1q_s32(x + i, vreinterpretq_s32_u32(u));
		vst1q_s32(y + i, vreinterpretq_s32_u32(v));
		u = vaddq_u32(u, dx);
		v = vaddq_u32(v, dy);
	}
	for (; i < span->count; i++) {
		x[i] = (int32_t)((uint32_t)span->x + i * (uint32_t)span->dx);
		y[i] = (int32_t)((uint32_t)span->y + i * (uint32_t)span->dy);
	}
}

#define LEVEL_KERNELS cpu_kernels_neon
#define LEVEL_NAME "neon"
#include "daemon/engine/cpu/kernels.h"
