/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the blur and the boost of a method need (docs/method.md, 4 to 6). */
#include "daemon/engine/method.h"

#include "daemon/engine/analysis/facts.h"
#include "daemon/engine/pass.h"
#include "shaders/limits.h"

static double smoothstep(double from, double to, double x)
{
	double t = (x - from) / (to - from);
	t = t > 0.0 ? t < 1.0 ? t : 1.0 : 0.0;
	return t * t * (3.0 - 2.0 * t);
}

double method_boost(const struct engine *engine)
{
	const struct plan_intervals intervals = plan_intervals_of(&engine->job.frame->header, engine->real_interval_ns);
	return 1.0 - smoothstep(BLOCH_FROM, BLOCH_GONE, (double)intervals.real * 1e-9);
}

/* Why the pictures E and B are the original, NULL if they are not. */
static const char *why_no_blur(const struct engine *engine)
{
	if (engine->params.blur == ENGINE_BLUR_OFF)
		return "off";
	if (engine->params.blur == ENGINE_BLUR_DOUBTFUL && !engine->mesh.doubtful.count &&
		!engine->params.leave_nothing_out)
		return "no-distortion";
	if (engine->params.no_compensation)
		return NULL;
	if (engine->n == 1)
		return "one-vblank";
	return engine->boost > 0.0 ? NULL : "slow";
}

int method_make_layers(struct engine *engine, struct error *error)
{
	const char *reason = why_no_blur(engine);
	engine->compensated = !reason;
	if (reason)
		report_leave_out(&engine->report, "blur", reason);
	if (reason || engine->params.no_compensation)
		report_leave_out(&engine->report, "boost", reason ? reason : "off");
	if (!engine->compensated)
		return 0;
	int result = pass_run(engine, PASS_PYRAMID, error);
	return result < 0 ? result : pass_run(engine, PASS_COMPENSATE, error);
}
