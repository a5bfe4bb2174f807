/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <immintrin.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/cpu/levels.h"
#include "daemon/engine/cpu/pixel.h"

struct span;
static inline void put_span(int32_t *restrict x, int32_t *restrict y, const struct span *span);

static inline __mmask16 first_lanes(uint32_t count)
{
	uint32_t mask = count >= 16 ? 0xffffu : (1u << count) - 1u;
	return (__mmask16)mask;
}

/* Eight pairs of neighbouring pixels, mixed by eight weights: four words of 16 bits each. */
static inline __m512i mix_pairs(__m512i pairs, __m512i weights)
{
	const __m512i interleave =
		_mm512_broadcast_i32x4(_mm_setr_epi8(0, 4, 1, 5, 2, 6, 3, 7, 8, 12, 9, 13, 10, 14, 11, 15));
	__m512i ordered = _mm512_xor_si512(_mm512_shuffle_epi8(pairs, interleave), _mm512_set1_epi8(-128));
	return _mm512_add_epi16(_mm512_maddubs_epi16(weights, ordered), _mm512_set1_epi16(32640));
}

/* Two rows of such words by weights of the lower one, 16 bits in each word; to bytes. */
static inline __m256i mix_rows(__m512i upper, __m512i lower, __m512i weights)
{
	__m512i others = _mm512_xor_si512(weights, _mm512_set1_epi16(-1));
	__m512i sum = _mm512_add_epi16(_mm512_mulhi_epu16(upper, others), _mm512_mulhi_epu16(lower, weights));
	sum = _mm512_add_epi16(sum, _mm512_set1_epi16(PIXEL_HALF));
	return _mm512_cvtepi16_epi8(_mm512_mulhi_epu16(sum, _mm512_set1_epi16(257)));
}

static inline __m512i clamped(__m512i at, uint32_t size)
{
	at = _mm512_max_epi32(at, _mm512_set1_epi32(-32768));
	return _mm512_min_epi32(at, _mm512_set1_epi32((int32_t)(size << 16) - 32768));
}

static inline __m512i weights_of(__m512i at)
{
	__m512i fraction = _mm512_and_si512(at, _mm512_set1_epi32(0xffff));
	__m512i scaled = _mm512_sub_epi32(_mm512_slli_epi32(fraction, 8), fraction);
	return _mm512_srli_epi32(_mm512_add_epi32(scaled, _mm512_set1_epi32(0x8000)), 16);
}

/* Eight samples: `at` pixels from the canvas's first, `across` and `down` as they are wanted in each of the words. */
static inline __m256i sample_8(const struct canvas *canvas, __m256i at, __m256i across, __m256i down)
{
	const __m512i spread =
		_mm512_set_epi64(0x0908090809080908, 0x0100010001000100, 0x0908090809080908, 0x0100010001000100,
						 0x0908090809080908, 0x0100010001000100, 0x0908090809080908, 0x0100010001000100);
	__m512i fx = _mm512_shuffle_epi8(_mm512_cvtepu32_epi64(across), spread);
	__m512i fy = _mm512_shuffle_epi8(_mm512_cvtepu32_epi64(down), spread);
	__m512i upper = _mm512_i32gather_epi64(at, canvas->pixels, 4);
	__m512i lower = _mm512_i32gather_epi64(at, canvas->pixels + canvas->stride, 4);
	return mix_rows(mix_pairs(upper, fx), mix_pairs(lower, fx), fy);
}

/* Where sixteen samples are: whole texels, and the weights of the second column and row as they are wanted. */
struct places {
	__m512i x, y;
	__m512i across; /* words: 255 - fx and fx as bytes */
	__m512i down;   /* words: fy x 257 */
};

static inline struct places places_of(const struct canvas *canvas, const int32_t *x, const int32_t *y)
{
	__m512i u = clamped(_mm512_load_si512(x), canvas->width), v = clamped(_mm512_load_si512(y), canvas->height);
	__m512i fx = weights_of(u), fy = weights_of(v);
	return (struct places){
		.x = _mm512_srai_epi32(u, 16),
		.y = _mm512_srai_epi32(v, 16),
		.across = _mm512_or_si512(_mm512_slli_epi32(fx, 8), _mm512_sub_epi32(_mm512_set1_epi32(255), fx)),
		.down = _mm512_or_si512(_mm512_slli_epi32(fy, 8), fy),
	};
}

/* From anywhere in the picture. */
static inline __m512i sample_16(const struct canvas *canvas, const struct places *places)
{
	const __m512i stride = _mm512_set1_epi32((int32_t)(canvas->stride / 4));
	__m512i at = _mm512_add_epi32(_mm512_mullo_epi32(places->y, stride), places->x);
	__m256i first = sample_8(canvas, _mm512_castsi512_si256(at), _mm512_castsi512_si256(places->across),
							 _mm512_castsi512_si256(places->down));
	__m256i second = sample_8(canvas, _mm512_extracti64x4_epi64(at, 1), _mm512_extracti64x4_epi64(places->across, 1),
							  _mm512_extracti64x4_epi64(places->down, 1));
	return _mm512_inserti64x4(_mm512_castsi256_si512(first), second, 1);
}

/* Sixteen pairs of neighbours mixed, in the order of unpacked vectors. */
struct mixed {
	__m512i low, high;
};

static inline __m512i mix_ordered(__m512i ordered, __m512i weights)
{
	ordered = _mm512_xor_si512(ordered, _mm512_set1_epi8(-128));
	return _mm512_add_epi16(_mm512_maddubs_epi16(weights, ordered), _mm512_set1_epi16(32640));
}

/* `at`: pixels from `row`, 0 to 30. */
static inline struct mixed mix_window(const uint8_t *row, __m512i at, const struct mixed *weights)
{
	__m512i first = _mm512_loadu_si512(row), second = _mm512_loadu_si512(row + 64);
	__m512i left = _mm512_permutex2var_epi32(first, at, second);
	__m512i right = _mm512_permutex2var_epi32(first, _mm512_add_epi32(at, _mm512_set1_epi32(1)), second);
	return (struct mixed){mix_ordered(_mm512_unpacklo_epi8(left, right), weights->low),
						  mix_ordered(_mm512_unpackhi_epi8(left, right), weights->high)};
}

static inline struct mixed chosen(__mmask16 mask, struct mixed a, struct mixed b)
{
	/* A pixel has four words: two of the 32-bit lanes. */
	__m512i lanes = _mm512_maskz_set1_epi32(mask, -1);
	__m512i low = _mm512_unpacklo_epi32(lanes, lanes), high = _mm512_unpackhi_epi32(lanes, lanes);
	return (struct mixed){_mm512_ternarylogic_epi32(low, b.low, a.low, 0xca),
						  _mm512_ternarylogic_epi32(high, b.high, a.high, 0xca)};
}

static inline __m512i words_of_rows(__m512i upper, __m512i lower, __m512i weights)
{
	__m512i others = _mm512_xor_si512(weights, _mm512_set1_epi16(-1));
	__m512i sum = _mm512_add_epi16(_mm512_mulhi_epu16(upper, others), _mm512_mulhi_epu16(lower, weights));
	sum = _mm512_add_epi16(sum, _mm512_set1_epi16(PIXEL_HALF));
	return _mm512_mulhi_epu16(sum, _mm512_set1_epi16(257));
}

/* Pixels before the first sample's that a window begins at. */
#define WINDOW_BEFORE 6

/*
 * From a window of 32 pixels in two or three rows, as most samples of a smooth motion are; false if they are not. Loads
 * are far cheaper than gathers.
 */
static inline bool sample_window(const struct canvas *canvas, const struct places *places, int32_t left, int32_t top,
								 __m512i *pixels)
{
	__m512i at = _mm512_sub_epi32(places->x, _mm512_set1_epi32(left));
	__m512i row = _mm512_sub_epi32(places->y, _mm512_set1_epi32(top));
	__mmask16 near = _mm512_cmplt_epu32_mask(at, _mm512_set1_epi32(31)), second = _mm512_test_epi32_mask(row, row);
	if ((near & _mm512_cmplt_epu32_mask(row, _mm512_set1_epi32(2))) != 0xffff)
		return false;
	const uint8_t *first = canvas_row(canvas, top) + 4 * (ptrdiff_t)left;
	const struct mixed across = {_mm512_unpacklo_epi32(places->across, places->across),
								 _mm512_unpackhi_epi32(places->across, places->across)};
	__m512i down = _mm512_or_si512(places->down, _mm512_slli_epi32(places->down, 16));
	struct mixed weights = {_mm512_or_si512(across.low, _mm512_slli_epi32(across.low, 16)),
							_mm512_or_si512(across.high, _mm512_slli_epi32(across.high, 16))};
	struct mixed upper = mix_window(first, at, &weights), lower = mix_window(first + canvas->stride, at, &weights);
	if (second) {
		struct mixed third = mix_window(first + 2 * canvas->stride, at, &weights);
		upper = chosen(second, upper, lower);
		lower = chosen(second, lower, third);
	}
	__m512i low = words_of_rows(upper.low, lower.low, _mm512_unpacklo_epi32(down, down));
	__m512i high = words_of_rows(upper.high, lower.high, _mm512_unpackhi_epi32(down, down));
	*pixels = _mm512_packus_epi16(low, high);
	return true;
}

static void sample_row(const struct canvas *canvas, const int32_t *x, const int32_t *y, uint32_t count, uint8_t *out)
{
	for (uint32_t i = 0; i < count; i += 16) {
		struct places places = places_of(canvas, x + i, y + i);
		int32_t left = pixel_clamp(x[i], canvas->width) >> 16, top = pixel_clamp(y[i], canvas->height) >> 16;
		int32_t last = pixel_clamp(y[i + 15], canvas->height) >> 16;
		left = left > WINDOW_BEFORE ? left - WINDOW_BEFORE : -1;
		__m512i pixels;
		if (!sample_window(canvas, &places, left, top < last ? top : last, &pixels))
			pixels = sample_16(canvas, &places);
		_mm512_mask_storeu_epi32(out + 4 * (size_t)i, first_lanes(count - i), pixels);
	}
}

/* Sixteen bytes of two rows and their neighbours four bytes on. */
static inline __m512i mix_neighbours(__m512i here, __m512i next, __m512i weights)
{
	__m512i ordered = _mm512_or_si512(here, _mm512_slli_epi16(next, 8));
	ordered = _mm512_xor_si512(ordered, _mm512_set1_epi8(-128));
	return _mm512_add_epi16(_mm512_maddubs_epi16(weights, ordered), _mm512_set1_epi16(32640));
}

static inline __m512i words_at(const uint8_t *bytes)
{
	return _mm512_cvtepu8_epi16(_mm256_loadu_si256((const __m256i *)(const void *)bytes));
}

/* Reads up to 32 bytes beyond, within the canvas's rows. */
static void shift_row(const uint8_t *upper, const uint8_t *lower, uint32_t fx, uint32_t fy, uint32_t count,
					  uint8_t *out)
{
	const __m512i across = _mm512_set1_epi16((int16_t)(fx << 8 | (255 - fx)));
	const __m512i down = _mm512_set1_epi16((int16_t)(fy * 257));
	uint32_t bytes = 4 * count, i = 0;
	for (; i + 32 <= bytes; i += 32) {
		__m512i above = mix_neighbours(words_at(upper + i), words_at(upper + i + 4), across);
		__m512i below = mix_neighbours(words_at(lower + i), words_at(lower + i + 4), across);
		_mm256_storeu_si256((__m256i *)(void *)(out + i), mix_rows(above, below, down));
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
	const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
	const __m512i dx = _mm512_set1_epi32(span->dx), dy = _mm512_set1_epi32(span->dy);
	__m512i u = _mm512_add_epi32(_mm512_set1_epi32(span->x), _mm512_mullo_epi32(lanes, dx));
	__m512i v = _mm512_add_epi32(_mm512_set1_epi32(span->y), _mm512_mullo_epi32(lanes, dy));
	for (uint32_t i = 0;; i += 16) {
		__mmask16 mask = first_lanes(span->count - i);
		_mm512_mask_storeu_epi32(x + i, mask, u);
		_mm512_mask_storeu_epi32(y + i, mask, v);
		if (i + 16 >= span->count)
			return;
		u = _mm512_add_epi32(u, _mm512_slli_epi32(dx, 4));
		v = _mm512_add_epi32(v, _mm512_slli_epi32(dy, 4));
	}
}

#define LEVEL_KERNELS cpu_kernels_avx512
#define LEVEL_NAME "avx512"
#include "daemon/engine/cpu/kernels.h"
