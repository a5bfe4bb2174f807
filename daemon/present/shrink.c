/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/shrink.h"

#include <stdlib.h>
#include <string.h>

/* sRGB's curve within 0.003, with nothing to look up: 0.035 v + 0.625 v^2 + 0.34 v^3. */
#define LINE 0.035f
#define SQUARE 0.625f
#define CUBE 0.34f
#define LANES 4u
#define CHANNELS 3u
/* The code of a light is looked up by its exponent, down to below that of code 1, and the first bits of its mantissa.
 */
#define OCTAVES 20u
#define DARKEST 0x1p-20f
#define MANTISSA_BITS 8u
#define DROPPED_BITS (23u - MANTISSA_BITS)
#define ENTRIES (OCTAVES << MANTISSA_BITS)
#define FIRST_ENTRY ((127u - OCTAVES) << MANTISSA_BITS)

typedef float floats __attribute__((vector_size(16)));
typedef int32_t ints __attribute__((vector_size(16)));

struct shrink {
	uint32_t width, height, to_width, to_height;
	size_t vectors;             /* in a row of a channel, with room for taps beyond its end */
	floats *row[CHANNELS];      /* sum over the rows that an output row covers */
	uint32_t taps, *first;      /* columns that an output pixel covers, some with weight 0 */
	float *weights;             /* taps x to_width */
	uint8_t codes[ENTRIES + 1]; /* by light */
};

/* ---- light ---- */

static float to_light(float code)
{
	const float v = code / 255.0f;
	return v * (LINE + v * (SQUARE + CUBE * v));
}

static float light_of_entry(uint32_t entry)
{
	const uint32_t bits = (FIRST_ENTRY + entry) << DROPPED_BITS | 1u << (DROPPED_BITS - 1);
	float light;
	memcpy(&light, &bits, sizeof(light));
	return light;
}

static void fill_codes(uint8_t codes[ENTRIES + 1])
{
	uint32_t code = 0;
	for (uint32_t i = 0; i <= ENTRIES; i++) {
		while (code < 255 && light_of_entry(i) > to_light((float)code + 0.5f))
			code++;
		codes[i] = (uint8_t)code;
	}
}

/* Of at least DARKEST and, but for rounding, at most 1. */
static uint32_t code_of(const struct shrink *shrink, float light)
{
	uint32_t bits;
	memcpy(&bits, &light, sizeof(bits));
	return shrink->codes[(bits >> DROPPED_BITS) - FIRST_ENTRY];
}

/* ---- life ---- */

/* How much of input `from` output `to` covers, times the number of outputs: lengths are whole numbers then. */
static uint32_t overlap(uint32_t from, uint32_t to, uint32_t inputs, uint32_t outputs)
{
	const uint64_t first = (uint64_t)from * outputs, start = (uint64_t)to * inputs;
	const uint64_t last = first + outputs, end = start + inputs;
	const uint64_t a = first > start ? first : start, b = last < end ? last : end;
	return b > a ? (uint32_t)(b - a) : 0;
}

static uint32_t first_of(uint32_t to, uint32_t inputs, uint32_t outputs)
{
	return (uint32_t)((uint64_t)to * inputs / outputs);
}

static void fill_taps(struct shrink *shrink)
{
	const uint32_t width = shrink->width, to_width = shrink->to_width;
	for (uint32_t x = 0; x < to_width; x++) {
		shrink->first[x] = first_of(x, width, to_width);
		for (uint32_t i = 0; i < shrink->taps; i++)
			shrink->weights[(size_t)x * shrink->taps + i] =
				(float)overlap(shrink->first[x] + i, x, width, to_width) / (float)width;
	}
}

struct shrink *shrink_create(uint32_t width, uint32_t height, uint32_t to_width, uint32_t to_height)
{
	struct shrink *shrink = calloc(1, sizeof(*shrink));
	if (!shrink)
		return NULL;
	shrink->width = width;
	shrink->height = height;
	shrink->to_width = to_width;
	shrink->to_height = to_height;
	shrink->taps = (width + to_width - 1) / to_width + (width % to_width != 0);
	shrink->vectors = ((size_t)width + shrink->taps) / LANES + 1;
	shrink->first = calloc(to_width, sizeof(*shrink->first));
	shrink->weights = calloc((size_t)to_width * shrink->taps, sizeof(*shrink->weights));
	shrink->row[0] = aligned_alloc(64, (CHANNELS * shrink->vectors * sizeof(floats) + 63) / 64 * 64);
	if (!shrink->first || !shrink->weights || !shrink->row[0]) {
		shrink_destroy(&shrink);
		return NULL;
	}
	shrink->row[1] = shrink->row[0] + shrink->vectors;
	shrink->row[2] = shrink->row[1] + shrink->vectors;
	fill_codes(shrink->codes);
	fill_taps(shrink);
	return shrink;
}

void shrink_destroy(struct shrink **shrink)
{
	struct shrink *self = *shrink;
	*shrink = NULL;
	if (!self)
		return;
	free(self->first);
	free(self->weights);
	free(self->row[0]);
	free(self);
}

/* ---- rows ---- */

static floats splat(float value)
{
	return (floats){value, value, value, value};
}

static floats light_of(ints pixels, int shift, const floats factors[3])
{
	const floats code = __builtin_convertvector(pixels >> shift & 255, floats);
	return code * (factors[0] + code * (factors[1] + code * factors[2]));
}

static ints load(const uint8_t *from, uint32_t left)
{
	ints pixels = {0, 0, 0, 0};
	if (left >= LANES)
		memcpy(&pixels, from, sizeof(pixels));
	else
		memcpy(&pixels, from, left * (size_t)4);
	return pixels;
}

static void add_row(const struct shrink *shrink, const uint8_t *from, float weight)
{
	const floats factors[3] = {splat(weight * LINE / 255.0f), splat(weight * SQUARE / (255.0f * 255.0f)),
							   splat(weight * CUBE / (255.0f * 255.0f * 255.0f))};
	floats *const blue = shrink->row[0], *const green = shrink->row[1], *const red = shrink->row[2];
	for (uint32_t x = 0; x < shrink->width; x += LANES) {
		const ints pixels = load(from + (size_t)x * 4, shrink->width - x);
		blue[x / LANES] += light_of(pixels, 0, factors);
		green[x / LANES] += light_of(pixels, 8, factors);
		red[x / LANES] += light_of(pixels, 16, factors);
	}
}

static void write_row(const struct shrink *shrink, uint8_t *to)
{
	const uint32_t taps = shrink->taps;
	for (uint32_t x = 0; x < shrink->to_width; x++) {
		const float *const weights = shrink->weights + (size_t)x * taps;
		const float *const blue = (const float *)shrink->row[0] + shrink->first[x];
		const float *const green = (const float *)shrink->row[1] + shrink->first[x];
		const float *const red = (const float *)shrink->row[2] + shrink->first[x];
		float b = DARKEST, g = DARKEST, r = DARKEST;
		for (uint32_t i = 0; i < taps; i++) {
			b += blue[i] * weights[i];
			g += green[i] * weights[i];
			r += red[i] * weights[i];
		}
		const uint32_t pixel = 0xff000000u | code_of(shrink, r) << 16 | code_of(shrink, g) << 8 | code_of(shrink, b);
		memcpy(to + (size_t)x * 4, &pixel, sizeof(pixel));
	}
}

void shrink_run(struct shrink *shrink, const uint8_t *from, size_t from_stride, uint8_t *to, size_t to_stride)
{
	for (uint32_t y = 0; y < shrink->to_height; y++) {
		const uint32_t first = first_of(y, shrink->height, shrink->to_height);
		uint32_t weight;
		memset(shrink->row[0], 0, CHANNELS * shrink->vectors * sizeof(floats));
		for (uint32_t i = first; (weight = overlap(i, y, shrink->height, shrink->to_height)) > 0; i++)
			add_row(shrink, from + i * from_stride, (float)weight / (float)shrink->height);
		write_row(shrink, to + y * to_stride);
	}
}
