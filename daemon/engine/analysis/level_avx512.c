/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <immintrin.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/analysis/values.h"

static inline size_t decode_half_some(const uint16_t *halves, size_t count, float *values)
{
	size_t i = 0;
	for (; i + 16 <= count; i += 16)
		_mm512_storeu_ps(values + i, _mm512_cvtph_ps(_mm256_loadu_si256((const __m256i *)(const void *)(halves + i))));
	return i;
}

typedef float wide __attribute__((vector_size(64), aligned(4), may_alias));

static inline wide wide_larger(wide a, wide b)
{
	return _mm512_max_ps(a, b);
}

typedef __m512i hash_lanes;

static inline hash_lanes hash_load(const uint8_t *bytes)
{
	return _mm512_loadu_si512(bytes);
}

static inline hash_lanes hash_step(hash_lanes hash, hash_lanes words)
{
	const __m512i factor = _mm512_set1_epi64(PLAN_HASH_FACTOR);
	hash = _mm512_xor_si512(hash, words);
	__m512i high = _mm512_mul_epu32(_mm512_srli_epi64(hash, 32), factor);
	hash = _mm512_add_epi64(_mm512_mul_epu32(hash, factor), _mm512_slli_epi64(high, 32));
	return _mm512_xor_si512(hash, _mm512_srli_epi64(hash, 32));
}

#define LEVEL_KERNELS plan_kernels_avx512
#define LEVEL_NAME "avx512"
#include "daemon/engine/analysis/kernels.h"
