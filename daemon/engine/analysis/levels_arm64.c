/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Levels of 64-bit ARM, which always has NEON. */
#include "daemon/engine/analysis/levels.h"

extern const struct plan_kernels plan_kernels_plain, plan_kernels_neon;

const struct plan_kernels *plan_level_kernels(enum plan_level level)
{
	switch (level) {
	case PLAN_LEVEL_PLAIN:
		return &plan_kernels_plain;
	case PLAN_LEVEL_NEON:
		return &plan_kernels_neon;
	default:
		return NULL;
	}
}

enum plan_level plan_level_best(void)
{
	return PLAN_LEVEL_NEON;
}
