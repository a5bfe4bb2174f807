/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Levels of x86-64. */
#include "daemon/engine/cpu/levels.h"

extern const struct cpu_kernels cpu_kernels_plain, cpu_kernels_avx2, cpu_kernels_avx512;

const struct cpu_kernels *cpu_level_kernels(enum cpu_level level)
{
	__builtin_cpu_init();
	switch (level) {
	case CPU_LEVEL_PLAIN:
		return &cpu_kernels_plain;
	case CPU_LEVEL_AVX2:
		return __builtin_cpu_supports("avx2") ? &cpu_kernels_avx2 : NULL;
	case CPU_LEVEL_AVX512:
		return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
					   __builtin_cpu_supports("avx512vl")
				   ? &cpu_kernels_avx512
				   : NULL;
	case CPU_LEVEL_NEON:
	case CPU_LEVEL_COUNT:
	default:
		return NULL;
	}
}

const struct cpu_kernels *cpu_level_best(void)
{
	for (int level = CPU_LEVEL_COUNT - 1; level > CPU_LEVEL_PLAIN; level--)
		if (cpu_level_kernels((enum cpu_level)level))
			return cpu_level_kernels((enum cpu_level)level);
	return &cpu_kernels_plain;
}
