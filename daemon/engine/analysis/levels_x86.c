/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Levels of x86-64. */
#include <cpuid.h>

#include "daemon/engine/analysis/levels.h"

extern const struct plan_kernels plan_kernels_plain, plan_kernels_avx2, plan_kernels_avx512;

static bool has_f16c(void)
{
	unsigned a, b, c, d;
	return __get_cpuid(1, &a, &b, &c, &d) && (c & bit_F16C);
}

const struct plan_kernels *plan_level_kernels(enum plan_level level)
{
	__builtin_cpu_init();
	switch (level) {
	case PLAN_LEVEL_PLAIN:
		return &plan_kernels_plain;
	case PLAN_LEVEL_AVX2:
		return __builtin_cpu_supports("avx2") && has_f16c() ? &plan_kernels_avx2 : NULL;
	case PLAN_LEVEL_AVX512:
		return __builtin_cpu_supports("avx512f") && has_f16c() ? &plan_kernels_avx512 : NULL;
	case PLAN_LEVEL_NEON:
	case PLAN_LEVEL_COUNT:
	default:
		return NULL;
	}
}

enum plan_level plan_level_best(void)
{
	for (int level = PLAN_LEVEL_COUNT - 1; level > PLAN_LEVEL_PLAIN; level--)
		if (plan_level_kernels((enum plan_level)level))
			return (enum plan_level)level;
	return PLAN_LEVEL_PLAIN;
}
