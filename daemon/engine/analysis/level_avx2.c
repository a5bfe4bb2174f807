/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <immintrin.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/analysis/values.h"

static inline size_t decode_half_some(const uint16_t *halves, size_t count, float *values)
{
	size_t i = 0;
	for (; i + 8 <= count; i += 8)
		_mm256_storeu_ps(values + i, _mm256_cvtph_ps(_mm_loadu_si128((const __m128i *)(const void *)(halves + i))));
	return i;
}

typedef float wide __attribute__((vector_size(32), aligned(4), may_alias));

static inline wide wide_larger(wide a, wide b)
{
	return _mm256_max_ps(a, b);
}

typedef __m256i hash_lanes;

static inline hash_lanes hash_load(const uint8_t *bytes)
{
	return _mm256_loadu_si256((const __m256i *)(const void *)bytes);
}

static inline hash_lanes hash_step(hash_lanes hash, hash_lanes words)
{
	const __m256i factor = _mm256_set1_epi64x(PLAN_HASH_FACTOR);
	hash = _mm256_xor_si256(hash, words);
	__m256i high = _mm256_mul_epu32(_mm256_srli_epi64(hash, 32), factor);
	hash = _mm256_add_epi64(_mm256_mul_epu32(hash, factor), _mm256_slli_epi64(high, 32));
	return _mm256_xor_si256(hash, _mm256_srli_epi64(hash, 32));
}

#define LEVEL_KERNELS plan_kernels_avx2
#define LEVEL_NAME "avx2"
#include "daemon/engine/analysis/kernels.h"
