/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The paper: Didyk et al. 2010, Sections 5 and 6; docs/method.md. */
#include "daemon/engine/method.h"
#include "daemon/engine/pass.h"

#include <math.h>

/* Merges only what moves alike to far less than the 1/256 pixel that renderers know. */
#define GRID_TOLERANCE 0.0005f

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

/* Whether depth settles what lies before what; if all of it is equal, drawing order does. */
static bool depth_varies(const struct plan *plan)
{
	for (uint32_t i = 1; i < plan->columns * plan->rows; i++)
		if (plan->vertices[i].z != plan->vertices[0].z)
			return true;
	return false;
}

/* The triangles for the GPU: merged where that changes nothing that could be seen. */
static int make_mesh(struct engine *engine, double phase, struct error *error)
{
	if (engine->bend.bent)
		bend_apply(&engine->bend, &engine->plan, phase);
	engine->has_depth = depth_varies(&engine->plan);
	engine->mesh.test_all = engine->params.leave_nothing_out;
	/* Merging changes the drawing order. */
	bool merge = (engine->has_depth || !engine->plan.folded) && !engine->params.leave_nothing_out;
	return warp_mesh_begin(&engine->mesh, &engine->plan, merge ? engine->method->tolerance : -1.0f,
						   engine->executor->pool, error);
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
	engine->levels_everywhere = engine->params.blur == ENGINE_BLUR_EVERYWHERE || engine->params.leave_nothing_out;
	engine->boost = method_boost(engine);
	result = make_mesh(engine, engine->last_phase, error);
	if (result == 0)
		result = warp_mesh_sort_doubtful(&engine->mesh, engine->params.blur_level, error);
	return result < 0 ? result : method_make_layers(engine, error);
}

/* The mesh for a phase, and L if something is torn there. */
static int sort_mesh(struct engine *engine, double phase, struct error *error)
{
	bool tears = engine->params.blur != ENGINE_BLUR_OFF;
	struct warp_mesh *mesh = &engine->mesh;
	/* Without triangles: memory ran out for the picture before. */
	int result = engine->bend.bent || mesh->count == 0 ? make_mesh(engine, phase, error) : 0;
	if (result == 0)
		result = warp_mesh_sort(mesh, (float)phase, tears, !engine->has_depth, error);
	/* Merged without a look at depths, since nothing folds at the last phase; but here it does. */
	if (result == 0 && !mesh->too_wild && mesh->folds.count && !engine->plan.folded &&
		mesh->count < engine->plan.index_count) {
		result = warp_mesh_begin(mesh, &engine->plan, -1.0f, engine->executor->pool, error);
		if (result == 0)
			result = warp_mesh_sort(mesh, (float)phase, tears, !engine->has_depth, error);
	}
	if (result < 0 || mesh->too_wild || (!mesh->torn.count && !mesh->folded_torn.count))
		return result;
	/* Stretch is convex in the phase: up to the last one, what is torn is also marked for blur. */
	bool marked = engine->bend.bent ? phase == engine->last_phase : phase >= 0.0 && phase <= engine->last_phase;
	if (engine->levels_made == LEVELS_ALL || (marked && engine->levels_made == LEVELS_MARKED))
		return 0;
	engine->levels_everywhere = !marked;
	return pass_run(engine, PASS_PYRAMID, error);
}

int grid_show(struct engine *engine, enum engine_show show, double phase, enum picture_id *picture, struct error *error)
{
	bool real = show == ENGINE_SHOW_REAL;
	*picture = PICTURE_ORIGINAL;
	if (show == ENGINE_SHOW_PLAIN || !engine->moves)
		return 0;
	if (engine->compensated)
		*picture = real ? PICTURE_REAL : PICTURE_BETWEEN;
	if (real && fabs(phase) <= METHOD_SAME_MOMENT)
		return 0;
	int result = sort_mesh(engine, phase, error);
	if (result < 0)
		return result;
	if (engine->mesh.too_wild) {
		report_leave_out(&engine->report, "warp", "too-wild");
		*picture = PICTURE_ORIGINAL;
		return 0;
	}
	engine->job.picture = *picture;
	engine->job.phase = phase;
	result = pass_run(engine, PASS_WARP, error);
	*picture = PICTURE_SHOWN;
	return result;
}

const struct method method_grid = {
	.name = "grid",
	.description = "the picture on a grid that snaps to motion edges (Didyk et al. 2010)",
	.tolerance = GRID_TOLERANCE,
	.begin = grid_begin,
	.show = grid_show,
};
