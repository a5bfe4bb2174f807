/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Plain C for the base machine: SSE2 on x86-64, NEON on arm64. */
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/analysis/row_hash_words.h"
#include "daemon/engine/analysis/values.h"

static inline size_t decode_half_some(const uint16_t *halves, size_t count, float *values)
{
	return 0;
}

typedef float wide __attribute__((vector_size(16), aligned(4), may_alias));
typedef int32_t wide_mask __attribute__((vector_size(16)));

static inline wide wide_larger(wide a, wide b)
{
	wide_mask larger = a > b;
	return (wide)(((wide_mask)a & larger) | ((wide_mask)b & ~larger));
}

#define LEVEL_KERNELS plan_kernels_plain
#define LEVEL_NAME "plain"
#include "daemon/engine/analysis/kernels.h"
