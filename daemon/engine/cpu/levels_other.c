/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Levels of other machines: what the compiler makes of plain C. */
#include "daemon/engine/cpu/levels.h"

extern const struct cpu_kernels cpu_kernels_plain;

const struct cpu_kernels *cpu_level_kernels(enum cpu_level level)
{
	return level == CPU_LEVEL_PLAIN ? &cpu_kernels_plain : NULL;
}

const struct cpu_kernels *cpu_level_best(void)
{
	return &cpu_kernels_plain;
}
