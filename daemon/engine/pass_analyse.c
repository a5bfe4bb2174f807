/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pass.h"

/* What led to a picture from one just like it did not move; where it is going to it tells by forward motion alone. */
static bool is_unchanged(const struct engine *engine)
{
	const struct damage *damage = &engine->damage;
	return damage->known && !damage->count &&
		   !(damage->found && engine->job.frame->header.motion_kind == PURSUIT_MOTION_FORWARD);
}

struct plan_params analyse_params(const struct engine *engine)
{
	const struct damage *damage = &engine->damage;
	const bool told = damage->known && !damage->found && !engine->params.leave_nothing_out;
	return (struct plan_params){
		.cell = engine->params.cell,
		.threshold_quarter = engine->params.threshold_quarter,
		.display_width_mm = engine->params.display_width_mm,
		.viewing_distance_mm = engine->params.viewing_distance_mm,
		.last_phase = (float)engine->last_phase,
		.real_interval_ns = engine->real_interval_ns,
		.unchanged = is_unchanged(engine),
		.damage = told ? damage->rectangles : NULL,
		.damage_count = damage->count,
		.pool = engine->executor->pool,
	};
}

int analyse_bend(struct engine *engine, const struct plan_params *params, struct error *error)
{
	if (engine->params.motion_model != ENGINE_MOTION_QUADRATIC)
		return 0;
	const int result = bend_begin(&engine->bend, engine->job.frame, &engine->plan, params, error);
	if (result == 0 && engine->plan.rest == PLAN_MOVES && engine->bend.reason)
		report_leave_out(&engine->report, "acceleration", engine->bend.reason);
	return result;
}

static int run(struct engine *engine, struct error *error)
{
	const struct plan_params params = analyse_params(engine);
	int result = plan_make(&engine->plan, engine->job.frame, &params, error);
	return result < 0 ? result : analyse_bend(engine, &params, error);
}

const struct pass pass_analyse = {.on_cpu = true, .run = run};
