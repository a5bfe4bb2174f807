/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/params.h"

#include <errno.h>

static int check_count(const char *name, uint32_t *value, uint32_t fallback, uint32_t low, uint32_t high,
					   struct error *error)
{
	if (!*value)
		*value = fallback;
	if (*value >= low && *value <= high)
		return 0;
	return error_set(error, -EINVAL, "%s is %u, must be %u to %u", name, *value, low, high);
}

static int check_number(const char *name, float *value, float fallback, float low, float high, struct error *error)
{
	if (*value == 0.0f)
		*value = fallback;
	if (*value >= low && *value <= high)
		return 0;
	return error_set(error, -EINVAL, "%s is %g, must be %g to %g", name, (double)*value, (double)low, (double)high);
}

static int check_choice(const char *name, unsigned value, unsigned highest, struct error *error)
{
	return value <= highest ? 0 : error_set(error, -EINVAL, "%s is %u, must be 0 to %u", name, value, highest);
}

int params_resolve(struct engine_params *params, struct error *error)
{
	int result = check_count("cell", &params->cell, 8, 4, 64, error);
	if (result == 0)
		result = check_count("blur_level", &params->blur_level, 2, 1, 6, error);
	if (result == 0)
		result = check_count("threshold_quarter", &params->threshold_quarter, 2, 1, 63, error);
	if (result == 0)
		result = check_number("display_width_mm", &params->display_width_mm, 531.0f, 1e-3f, 1e6f, error);
	if (result == 0)
		result = check_number("viewing_distance_mm", &params->viewing_distance_mm, 600.0f, 1e-3f, 1e6f, error);
	if (result == 0 && params->threads > 8)
		result = error_set(error, -EINVAL, "threads is %u, must be 0 to 8", params->threads);
	if (result == 0)
		result = check_choice("blur", (unsigned)params->blur, ENGINE_BLUR_OFF, error);
	if (result == 0)
		result = check_choice("motion_model", (unsigned)params->motion_model, ENGINE_MOTION_QUADRATIC, error);
	if (result == 0)
		result = check_choice("analysis", (unsigned)params->analysis, ENGINE_ANALYSIS_GPU, error);
	if (result == 0)
		result = check_choice("curve", (unsigned)params->curve, ENGINE_CURVE_GAMMA, error);
	if (result == 0 && params->curve == ENGINE_CURVE_GAMMA)
		result = check_number("gamma", &params->gamma, 2.2f, 1.0f, 5.0f, error);
	else
		params->gamma = 0.0f;
	return result;
}
