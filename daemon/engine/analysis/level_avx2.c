/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <immintrin.h>
#include <stddef.h>
#include <stdint.h>

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

#define LEVEL_KERNELS plan_kernels_avx2
#define LEVEL_NAME "avx2"
#include "daemon/engine/analysis/kernels.h"
