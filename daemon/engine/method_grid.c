/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The paper: Didyk et al. 2010, Sections 5 and 6; docs/method.md. */
#include "daemon/engine/method.h"
#include "daemon/engine/pass.h"

#include <math.h>

#include "shaders/limits.h"

/* Closer to the real frame's own moment than this, it is shown undisplaced. */
#define SAME_MOMENT 0.05

static double smoothstep(double from, double to, double x)
{
	double t = (x - from) / (to - from);
	t = t > 0.0 ? t < 1.0 ? t : 1.0 : 0.0;
	return t * t * (3.0 - 2.0 * t);
}

/* Why the pictures E and B are the original, NULL if they are not. */
static const char *why_no_blur(const struct engine *engine)
{
	if (engine->params.blur == ENGINE_BLUR_OFF)
		return "off";
	if (engine->params.blur == ENGINE_BLUR_DOUBTFUL && !engine->mesh.doubtful_count)
		return "no-distortion";
	if (engine->params.no_compensation)
		return NULL;
	if (engine->n == 1)
		return "one-vblank";
	return engine->boost > 0.0 ? NULL : "slow";
}

static void note_plan(struct engine *engine)
{
	struct engine_report *report = &engine->report;
	report->vertices = engine->plan.columns * engine->plan.rows;
	report->triangles = engine->plan.index_count / 3;
	report->snapped = engine->plan.snapped;
	report->folded = engine->plan.folded;
	report->doubtful = engine->plan.doubtful;
	report->invalid_pixels = engine->plan.invalid_pixels;
	if (!engine->plan.snapped)
		report_leave_out(report, "snap", "no-discontinuity");
	if (!engine->plan.folded)
		report_leave_out(report, "depth-test", "no-fold");
}

/* What the blur and the boost need, if anything needs them. */
static int make_layers(struct engine *engine, struct error *error)
{
	const char *reason = why_no_blur(engine);
	engine->compensated = !reason;
	engine->tears = engine->params.blur != ENGINE_BLUR_OFF && engine->mesh.torn_count;
	if (reason)
		report_leave_out(&engine->report, "blur", reason);
	if (reason || engine->params.no_compensation)
		report_leave_out(&engine->report, "boost", reason ? reason : "off");
	int result = 0;
	engine->has_levels = engine->compensated || engine->tears;
	if (engine->has_levels)
		result = pass_run(engine, PASS_PYRAMID, error);
	if (result == 0 && engine->compensated)
		result = pass_run(engine, PASS_COMPENSATE, error);
	return result;
}

static int upload_mesh(struct engine *engine, bool ordered, struct error *error)
{
	int result = warp_mesh_upload(&engine->mesh, engine_gl(engine), &engine->plan, ordered, error);
	engine->report.bytes_up += engine->mesh.bytes;
	return result;
}

int grid_begin(struct engine *engine, struct error *error)
{
	int result = pass_run(engine, PASS_ANALYSE, error);
	if (result < 0)
		return result;
	engine->moves = engine->plan.rest == PLAN_MOVES && engine->plan.index_count > 0;
	if (!engine->moves) {
		report_leave_out(&engine->report, "extrapolation", plan_rest_name(engine->plan.rest));
		return 0;
	}
	note_plan(engine);
	engine->boost = 1.0 - smoothstep(BLOCH_FROM, BLOCH_GONE, engine->plan.real_interval_s);
	/* Where depths are all equal, a fold is settled by drawing order. */
	result = upload_mesh(engine, engine->plan.folded && !engine->has_depth, error);
	return result < 0 ? result : make_layers(engine, error);
}

/* The lists hold from phase 0 to the last one, where stretch is convex in the phase; elsewhere all is looked at anew. */
static int leave_range(struct engine *engine, double phase, struct error *error)
{
	int result = engine->mesh.ordered ? 0 : upload_mesh(engine, true, error);
	if (result < 0 || engine->tears || engine->params.blur == ENGINE_BLUR_OFF)
		return result;
	engine->tears = warp_mesh_tears(&engine->plan, (float)phase);
	if (!engine->tears || engine->has_levels)
		return 0;
	engine->has_levels = true;
	return pass_run(engine, PASS_PYRAMID, error);
}

int grid_show(struct engine *engine, enum engine_show show, double phase, const struct target **picture,
              struct error *error)
{
	bool real = show == ENGINE_SHOW_REAL;
	*picture = &engine->color;
	if (show == ENGINE_SHOW_PLAIN || !engine->moves)
		return 0;
	if (engine->compensated)
		*picture = real ? &engine->real : &engine->between;
	if (real && fabs(phase) <= SAME_MOMENT)
		return 0;
	int result = phase >= 0.0 && phase <= engine->last_phase ? 0 : leave_range(engine, phase, error);
	if (result < 0)
		return result;
	engine->job.picture = *picture;
	engine->job.phase = phase;
	result = pass_run(engine, PASS_WARP, error);
	*picture = &engine->shown;
	return result;
}

const struct method method_grid = {
	.name = "grid",
	.description = "the picture on a grid that snaps to motion edges (Didyk et al. 2010)",
	.begin = grid_begin,
	.show = grid_show,
};
