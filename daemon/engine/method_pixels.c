/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/method_pixels.h"

#include "daemon/engine/pass.h"

int pixels_begin(struct engine *engine, struct error *error)
{
	int result = pass_run(engine, PASS_FIELD, error);
	if (result < 0)
		return result;
	const enum plan_rest rest = pixel_state_now(&engine->pixels)->dense.rest;
	engine->moves = rest == PLAN_MOVES;
	if (!engine->moves)
		report_leave_out(&engine->report, "extrapolation", plan_rest_name(rest));
	report_leave_out(&engine->report, "blur", "method");
	report_leave_out(&engine->report, "boost", "method");
	return 0;
}

int pixels_show(struct engine *engine, int (*paint)(struct engine *engine, struct error *error), double phase,
				enum picture_id *picture, struct error *error)
{
	engine->job.paint = paint;
	engine->job.phase = phase;
	int result = pass_run(engine, PASS_PAINT, error);
	if (result == 0)
		result = pass_run(engine, PASS_PUT, error);
	*picture = PICTURE_SHOWN;
	return result;
}
