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

/* The first `count` of eight lanes. */
static inline __m256i first_lanes(uint32_t count)
{
	const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
	return _mm256_cmpgt_epi32(_mm256_set1_epi32((int32_t)count), lanes);
}

/* Four pairs of neighbouring pixels, mixed by four weights: four words of 16 bits each. */
static inline __m256i mix_pairs(__m256i pairs, __m256i weights)
{
	const __m256i interleave =
		_mm256_broadcastsi128_si256(_mm_setr_epi8(0, 4, 1, 5, 2, 6, 3, 7, 8, 12, 9, 13, 10, 14, 11, 15));
	__m256i ordered = _mm256_xor_si256(_mm256_shuffle_epi8(pairs, interleave), _mm256_set1_epi8(-128));
	return _mm256_add_epi16(_mm256_maddubs_epi16(weights, ordered), _mm256_set1_epi16(32640));
}

/* Two rows of such words by weights of the lower one; words below 256. */
static inline __m256i mix_rows(__m256i upper, __m256i lower, __m256i weights)
{
	__m256i others = _mm256_xor_si256(weights, _mm256_set1_epi16(-1));
	__m256i sum = _mm256_add_epi16(_mm256_mulhi_epu16(upper, others), _mm256_mulhi_epu16(lower, weights));
	sum = _mm256_add_epi16(sum, _mm256_set1_epi16(PIXEL_HALF));
	return _mm256_mulhi_epu16(sum, _mm256_set1_epi16(257));
}

static inline __m256i clamped(__m256i at, uint32_t size)
{
	at = _mm256_max_epi32(at, _mm256_set1_epi32(-32768));
	return _mm256_min_epi32(at, _mm256_set1_epi32((int32_t)(size << 16) - 32768));
}

static inline __m256i weights_of(__m256i at)
{
	__m256i fraction = _mm256_and_si256(at, _mm256_set1_epi32(0xffff));
	__m256i scaled = _mm256_sub_epi32(_mm256_slli_epi32(fraction, 8), fraction);
	return _mm256_srli_epi32(_mm256_add_epi32(scaled, _mm256_set1_epi32(0x8000)), 16);
}

/* Four pairs of neighbouring pixels; by loads, which take a quarter less of the whole time than gathers do. */
static inline __m256i load_pairs(const uint8_t *pixels, __m128i at)
{
	const int64_t low = _mm_cvtsi128_si64(at), high = _mm_extract_epi64(at, 1);
	__m128i a = _mm_loadl_epi64((const __m128i *)(const void *)(pixels + 4 * (ptrdiff_t)(int32_t)low));
	__m128i b = _mm_loadl_epi64((const __m128i *)(const void *)(pixels + 4 * (ptrdiff_t)(low >> 32)));
	__m128i c = _mm_loadl_epi64((const __m128i *)(const void *)(pixels + 4 * (ptrdiff_t)(int32_t)high));
	__m128i d = _mm_loadl_epi64((const __m128i *)(const void *)(pixels + 4 * (ptrdiff_t)(high >> 32)));
	return _mm256_set_m128i(_mm_unpacklo_epi64(c, d), _mm_unpacklo_epi64(a, b));
}

/* Four samples as words. */
static inline __m256i sample_4(const struct canvas *canvas, __m128i at, __m128i across, __m128i down)
{
	const __m256i spread = _mm256_setr_epi8(0, 1, 0, 1, 0, 1, 0, 1, 8, 9, 8, 9, 8, 9, 8, 9, 0, 1, 0, 1, 0, 1, 0, 1, 8,
											9, 8, 9, 8, 9, 8, 9);
	__m256i fx = _mm256_shuffle_epi8(_mm256_cvtepu32_epi64(across), spread);
	__m256i fy = _mm256_shuffle_epi8(_mm256_cvtepu32_epi64(down), spread);
	__m256i upper = load_pairs(canvas->pixels, at), lower = load_pairs(canvas->pixels + canvas->stride, at);
	return mix_rows(mix_pairs(upper, fx), mix_pairs(lower, fx), fy);
}

static inline __m256i sample_8(const struct canvas *canvas, __m256i x, __m256i y)
{
	const __m256i stride = _mm256_set1_epi32((int32_t)(canvas->stride / 4));
	__m256i u = clamped(x, canvas->width), v = clamped(y, canvas->height);
	__m256i at = _mm256_add_epi32(_mm256_mullo_epi32(_mm256_srai_epi32(v, 16), stride), _mm256_srai_epi32(u, 16));
	__m256i fx = weights_of(u), fy = weights_of(v);
	__m256i across = _mm256_or_si256(_mm256_slli_epi32(fx, 8), _mm256_sub_epi32(_mm256_set1_epi32(255), fx));
	__m256i down = _mm256_or_si256(_mm256_slli_epi32(fy, 8), fy);
	__m256i first =
		sample_4(canvas, _mm256_castsi256_si128(at), _mm256_castsi256_si128(across), _mm256_castsi256_si128(down));
	__m256i second = sample_4(canvas, _mm256_extracti128_si256(at, 1), _mm256_extracti128_si256(across, 1),
							  _mm256_extracti128_si256(down, 1));
	return _mm256_permute4x64_epi64(_mm256_packus_epi16(first, second), 0xd8);
}

static void sample_row(const struct canvas *canvas, const int32_t *x, const int32_t *y, uint32_t count, uint8_t *out)
{
	for (uint32_t i = 0; i < count; i += 8) {
		__m256i pixels = sample_8(canvas, _mm256_load_si256((const __m256i *)(const void *)(x + i)),
								  _mm256_load_si256((const __m256i *)(const void *)(y + i)));
		_mm256_maskstore_epi32((int *)(void *)(out + 4 * (size_t)i), first_lanes(count - i), pixels);
	}
}

static inline __m256i words_at(const uint8_t *bytes)
{
	return _mm256_cvtepu8_epi16(_mm_loadu_si128((const __m128i *)(const void *)bytes));
}

static inline __m256i mix_neighbours(const uint8_t *bytes, __m256i weights)
{
	__m256i ordered = _mm256_or_si256(words_at(bytes), _mm256_slli_epi16(words_at(bytes + 4), 8));
	ordered = _mm256_xor_si256(ordered, _mm256_set1_epi8(-128));
	return _mm256_add_epi16(_mm256_maddubs_epi16(weights, ordered), _mm256_set1_epi16(32640));
}

static void shift_row(const uint8_t *upper, const uint8_t *lower, uint32_t fx, uint32_t fy, uint32_t count,
					  uint8_t *out)
{
	const __m256i across = _mm256_set1_epi16((int16_t)(fx << 8 | (255 - fx)));
	const __m256i down = _mm256_set1_epi16((int16_t)(fy * 257));
	uint32_t bytes = 4 * count, i = 0;
	for (; i + 32 <= bytes; i += 32) {
		__m256i first = mix_rows(mix_neighbours(upper + i, across), mix_neighbours(lower + i, across), down);
		__m256i second = mix_rows(mix_neighbours(upper + i + 16, across), mix_neighbours(lower + i + 16, across), down);
		__m256i packed = _mm256_permute4x64_epi64(_mm256_packus_epi16(first, second), 0xd8);
		_mm256_storeu_si256((__m256i *)(void *)(out + i), packed);
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
	const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
	const __m256i dx = _mm256_set1_epi32(span->dx), dy = _mm256_set1_epi32(span->dy);
	__m256i u = _mm256_add_epi32(_mm256_set1_epi32(span->x), _mm256_mullo_epi32(lanes, dx));
	__m256i v = _mm256_add_epi32(_mm256_set1_epi32(span->y), _mm256_mullo_epi32(lanes, dy));
	for (uint32_t i = 0; i < span->count; i += 8) {
		__m256i mask = first_lanes(span->count - i);
		_mm256_maskstore_epi32(x + i, mask, u);
		_mm256_maskstore_epi32(y + i, mask, v);
		u = _mm256_add_epi32(u, _mm256_slli_epi32(dx, 3));
		v = _mm256_add_epi32(v, _mm256_slli_epi32(dy, 3));
	}
}

#define LEVEL_KERNELS cpu_kernels_avx2
#define LEVEL_NAME "avx2"
#include "daemon/engine/cpu/kernels.h"
