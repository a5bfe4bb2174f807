/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Plain C for the base machine: SSE2 on x86-64, NEON on arm64. */
#include <stddef.h>
#include <stdint.h>
#include <string.h>

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

typedef uint64_t hash_lanes;

static inline hash_lanes hash_load(const uint8_t *bytes)
{
	hash_lanes words;
	memcpy(&words, bytes, sizeof(words));
	return words;
}

static inline hash_lanes hash_step(hash_lanes hash, hash_lanes words)
{
	return plan_hash_step(hash, words);
}

#define LEVEL_KERNELS plan_kernels_plain
#define LEVEL_NAME "plain"
#include "daemon/engine/analysis/kernels.h"
