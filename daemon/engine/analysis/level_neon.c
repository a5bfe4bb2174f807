/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <arm_neon.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/analysis/row_hash_words.h"
#include "daemon/engine/analysis/values.h"

static inline size_t decode_half_some(const uint16_t *halves, size_t count, float *values)
{
	size_t i = 0;
	for (; i + 4 <= count; i += 4)
		vst1q_f32(values + i, vcvt_f32_f16(vreinterpret_f16_u16(vld1_u16(halves + i))));
	return i;
}

typedef float wide __attribute__((vector_size(16), aligned(4), may_alias));

static inline wide wide_larger(wide a, wide b)
{
	return (wide)vmaxq_f32((float32x4_t)a, (float32x4_t)b);
}

#define LEVEL_KERNELS plan_kernels_neon
#define LEVEL_NAME "neon"
#include "daemon/engine/analysis/kernels.h"
