/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pass.h"

static int run(struct engine *engine, struct error *error)
{
	struct plan_params params = {
		.cell = engine->params.cell,
		.threshold_quarter = engine->params.threshold_quarter,
		.display_width_mm = engine->params.display_width_mm,
		.viewing_distance_mm = engine->params.viewing_distance_mm,
		.last_phase = (float)engine->last_phase,
		.real_interval_ns = engine->real_interval_ns,
		.unchanged = engine->damage.known && !engine->damage.count,
		.pool = engine->executor->pool,
	};
	int result = plan_make(&engine->plan, engine->job.frame, &params, error);
	if (result == 0 && engine->params.motion_model == ENGINE_MOTION_QUADRATIC)
		result = bend_begin(&engine->bend, engine->job.frame, &engine->plan, &params, error);
	return result;
}

const struct pass pass_analyse = {.on_cpu = true, .run = run};
