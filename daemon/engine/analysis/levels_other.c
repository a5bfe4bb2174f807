/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Levels of other machines: what the compiler makes of plain C. */
#include "daemon/engine/analysis/levels.h"

extern const struct plan_kernels plan_kernels_plain;

const struct plan_kernels *plan_level_kernels(enum plan_level level)
{
	return level == PLAN_LEVEL_PLAIN ? &plan_kernels_plain : NULL;
}

enum plan_level plan_level_best(void)
{
	return PLAN_LEVEL_PLAIN;
}
