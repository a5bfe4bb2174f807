/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Levels of 64-bit ARM, which always has NEON. */
#include "daemon/engine/cpu/levels.h"

extern const struct cpu_kernels cpu_kernels_plain, cpu_kernels_neon;

const struct cpu_kernels *cpu_level_kernels(enum cpu_level level)
{
	switch (level) {
	case CPU_LEVEL_PLAIN:
		return &cpu_kernels_plain;
	case CPU_LEVEL_NEON:
		return &cpu_kernels_neon;
	default:
		return NULL;
	}
}

const struct cpu_kernels *cpu_level_best(void)
{
	return &cpu_kernels_neon;
}
