/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <immintrin.h>
#include <stddef.h>
#include <stdint.h>

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

#define LEVEL_KERNELS plan_kernels_avx512
#define LEVEL_NAME "avx512"
#include "daemon/engine/analysis/kernels.h"
