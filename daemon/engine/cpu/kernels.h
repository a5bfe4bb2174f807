/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The kernels that compilers turn into vectors by themselves, once per level; see tile.h for the others. */

#include <string.h>

/* 255 x (a / 255), rounded, of two channels at once. */
static inline uint32_t scale_pair(uint32_t pair, uint32_t factor)
{
	pair = pair * factor + 0x00800080u;
	return (pair + ((pair >> 8) & 0x00ff00ffu)) >> 8 & 0x00ff00ffu;
}

static inline uint32_t add_pair(uint32_t a, uint32_t b)
{
	uint32_t sum = a + b, over = sum & 0x01000100u;
	return (sum | (over - (over >> 8))) & 0x00ff00ffu;
}

static void blend_row(uint8_t *restrict pixels, const uint8_t *restrict ui, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		uint32_t below, above;
		memcpy(&below, pixels + 4 * (size_t)i, 4);
		memcpy(&above, ui + 4 * (size_t)i, 4);
		uint32_t rest = 255u - (above >> 24);
		uint32_t even = add_pair(above & 0x00ff00ffu, scale_pair(below & 0x00ff00ffu, rest));
		uint32_t odd = add_pair(above >> 8 & 0x00ff00ffu, scale_pair(below >> 8 & 0x00ff00ffu, rest));
		below = even | odd << 8 | 0xff000000u;
		memcpy(pixels + 4 * (size_t)i, &below, 4);
	}
}

#define HALVE_BLOCK 64u

/* Down the columns first, then every other one along the row: sixteenths, halves upwards. */
static void halve_row(const uint8_t *const rows[3], uint32_t first, uint32_t count, uint8_t *restrict out)
{
	uint16_t sums[4 * (2 * HALVE_BLOCK + 1)];
	for (uint32_t done = 0; done < count; done += HALVE_BLOCK) {
		uint32_t some = count - done < HALVE_BLOCK ? count - done : HALVE_BLOCK;
		ptrdiff_t at = 4 * (2 * (ptrdiff_t)(first + done) - 1);
		const uint8_t *a = rows[0] + at, *b = rows[1] + at, *c = rows[2] + at;
		for (uint32_t i = 0; i < 4 * (2 * some + 1); i++)
			sums[i] = (uint16_t)(a[i] + 2 * b[i] + c[i]);
		uint8_t *to = out + 4 * (size_t)(first + done);
		for (uint32_t i = 0; i < some; i++)
			for (uint32_t k = 0; k < 4; k++) {
				const uint16_t *sum = sums + 8 * i + k;
				to[4 * i + k] = (uint8_t)((sum[0] + 2 * sum[4] + sum[8] + 8) >> 4);
			}
	}
}

#define SPLINE_BLOCK 128u

static void spline_row(const uint8_t *const rows[4], const float wy[4], const float (*wx)[4], uint32_t shift,
					   uint32_t first, uint32_t count, uint8_t *restrict out)
{
	float columns[4 * (SPLINE_BLOCK / 2 + 6)];
	for (uint32_t done = 0; done < count; done += SPLINE_BLOCK) {
		uint32_t begin = first + done, end = count - done < SPLINE_BLOCK ? first + count : begin + SPLINE_BLOCK;
		uint32_t texel = begin >> shift, texels = ((end - 1) >> shift) - texel + 4;
		ptrdiff_t at = 4 * ((ptrdiff_t)texel - 1);
		for (uint32_t i = 0; i < 4 * texels; i++)
			columns[i] = (wy[0] * (float)rows[0][at + i] + wy[1] * (float)rows[1][at + i]) +
						 (wy[2] * (float)rows[2][at + i] + wy[3] * (float)rows[3][at + i]);
		for (uint32_t x = begin; x < end; x++) {
			const float *w = wx[x & ((1u << shift) - 1u)], *from = columns + 4 * ((x >> shift) - texel);
			for (uint32_t k = 0; k < 4; k++) {
				float sum = (w[0] * from[k] + w[1] * from[k + 4]) + (w[2] * from[k + 8] + w[3] * from[k + 12]);
				out[4 * (size_t)x + k] = (uint8_t)(int32_t)(sum + 0.5f);
			}
		}
	}
}

static inline float light_of(const struct light *light, float code)
{
	float at = code * (float)LIGHT_FINE;
	int32_t index = (int32_t)at;
	float part = at - (float)index, here = light->fine[index];
	return here + part * (light->fine[index + 1] - here);
}

static inline uint8_t code_of(const struct light *light, float value)
{
	value = value < 1.0f ? value : 1.0f;
	value = value > 0.0f ? value : 0.0f;
	uint32_t bits;
	memcpy(&bits, &value, sizeof(bits));
	const uint32_t low_bits = 23u - LIGHT_MANTISSA_BITS;
	bool below = bits < light->least_bits;
	uint32_t offset = below ? 0 : bits - light->least_bits, index = offset >> low_bits;
	float part = (float)(int32_t)(offset & ((1u << low_bits) - 1u)) * (1.0f / (float)(1u << low_bits));
	float here = light->codes[index], code = here + part * (light->codes[index + 1] - here);
	code = below ? value * light->below : code;
	return (uint8_t)(int32_t)(code + 0.5f);
}

/* B and E of one channel. */
static inline void compensate_one(const struct light *light, uint8_t color, uint8_t low, float weight, uint8_t *between,
								  uint8_t *real)
{
	float mixed = (float)color + weight * ((float)low - (float)color);
	float original = light->fine[color * LIGHT_FINE];
	float most = light_of(light, mixed), rest = (light->count * original - 1.0f) / (light->count - 1.0f);
	float dark = most > rest ? most : rest;
	dark = dark < original ? dark : original;
	float gain = light->boost * (original - dark);
	*between = code_of(light, original - gain);
	*real = code_of(light, original + (light->count - 1.0f) * gain);
}

static void compensate(const struct light *light, const uint8_t *restrict color, const uint8_t *restrict low,
					   const float *restrict weights, uint32_t count, uint8_t *restrict between, uint8_t *restrict real)
{
	for (uint32_t i = 0; i < 4 * count; i++) {
		float weight = weights[i / 4];
		if (!(weight > 0.0f) || i % 4 == 3) {
			between[i] = real[i] = color[i];
		} else if (light->mix_only) {
			between[i] = (uint8_t)(int32_t)((float)color[i] + weight * ((float)low[i] - (float)color[i]) + 0.5f);
			real[i] = color[i];
		} else {
			compensate_one(light, color[i], low[i], weight, &between[i], &real[i]);
		}
	}
}

extern const struct cpu_kernels LEVEL_KERNELS;
const struct cpu_kernels LEVEL_KERNELS = {
	.name = LEVEL_NAME,
	.draw_tile = draw_tile,
	.blend_row = blend_row,
	.halve_row = halve_row,
	.spline_row = spline_row,
	.compensate = compensate,
};
