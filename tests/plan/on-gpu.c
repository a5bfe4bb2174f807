/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "on-gpu.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "daemon/engine/gl/executor_gl.h"
#include "daemon/engine/pass.h"

struct engine *on_gpu_open(const char *kind, struct error *error)
{
	struct engine_params params = {.context = ENGINE_CONTEXT_EGL_SURFACELESS, .analysis = ENGINE_ANALYSIS_GPU};
	params.gles = strcmp(kind, "gles") == 0;
	if (strcmp(kind, "osmesa") == 0)
		params.context = ENGINE_CONTEXT_OSMESA;
	struct engine *engine = engine_create(&params, error);
	if (engine && !table_of(engine)->compute) {
		engine_destroy(&engine);
		error_set(error, 0, "this renderer has no compute shaders");
	}
	return engine;
}

bool on_gpu_analyse(struct engine *engine, const struct frame *frame, const struct plan_params *params)
{
	struct error error = {""};
	struct engine_params *own = &engine->params;
	own->cell = params->cell;
	own->threshold_quarter = params->threshold_quarter;
	own->display_width_mm = params->display_width_mm;
	own->viewing_distance_mm = params->viewing_distance_mm;
	engine->last_phase = (double)params->last_phase;
	engine->real_interval_ns = params->real_interval_ns;
	engine->damage.known = false;
	report_begin(&engine->report, 0, "");
	int result = engine->executor->ops->enter(engine->executor, &error);
	engine->job.frame = frame;
	if (result == 0)
		result = pass_run(engine, PASS_ANALYSE, &error);
	engine->job.frame = NULL;
	if (result < 0)
		fprintf(stderr, "%s\n", error.text);
	return result == 0;
}

/* As far as rounding goes; what is below a denormal may be 0. */
static bool alike(float a, float b)
{
	return fabsf(a - b) <= 2e-6f * (fabsf(b) > 1.0f ? fabsf(b) : 1.0f);
}

static bool alike_vertices(const struct plan_vertex *a, const struct plan_vertex *b)
{
	return a->x == b->x && a->y == b->y && alike(a->ux, b->ux) && alike(a->uy, b->uy) && alike(a->z, b->z) &&
		   a->snapped == b->snapped;
}

static bool same_facts(const struct plan *a, const struct plan *b)
{
	return a->rest == b->rest && a->columns == b->columns && a->rows == b->rows && a->index_count == b->index_count &&
		   a->snapped == b->snapped && a->invalid_pixels == b->invalid_pixels && a->folded == b->folded &&
		   a->doubtful == b->doubtful && alike(a->max_displacement, b->max_displacement);
}

static void print_vertex(const struct plan_vertex *v, const char *end)
{
	fprintf(stderr, "%g %g  %g %g  %g %g%s", (double)v->x, (double)v->y, (double)v->ux, (double)v->uy, (double)v->z,
			(double)v->snapped, end);
}

/* Vertices that differ by more than rounding. */
static uint32_t compare_vertices(const struct plan *got, const struct plan *want, struct on_gpu_totals *totals)
{
	uint32_t wrong = 0;
	for (uint32_t i = 0; i < want->columns * want->rows; i++) {
		const struct plan_vertex *a = &got->vertices[i], *b = &want->vertices[i];
		totals->vertices++;
		totals->equal += memcmp(a, b, sizeof(*a)) == 0;
		if (alike_vertices(a, b) || wrong++ > 1)
			continue;
		fprintf(stderr, "vertex %u: ", i);
		print_vertex(a, ", not ");
		print_vertex(b, "\n");
	}
	return wrong;
}

static bool same_tiles(const struct plan *got, const struct plan *want)
{
	uint32_t counts[2][PLAN_TILE_CLASSES];
	plan_count_tiles(got, 1.0f / 32.0f, counts[0]);
	plan_count_tiles(want, 1.0f / 32.0f, counts[1]);
	return memcmp(counts[0], counts[1], sizeof(counts[0])) == 0;
}

static bool same_plan(const struct plan *got, const struct plan *want, struct on_gpu_totals *totals)
{
	if (!same_facts(got, want)) {
		plan_print(got, stderr);
		plan_print(want, stderr);
		return false;
	}
	if (want->rest == PLAN_MOVES &&
		(compare_vertices(got, want, totals) > 0 ||
		 memcmp(got->indices, want->indices, want->index_count * sizeof(*want->indices)) != 0))
		return false;
	return same_tiles(got, want);
}

bool on_gpu_alike(struct engine *engine, const struct frame *frame, const struct plan_params *params, const char *what,
				  struct on_gpu_totals *totals)
{
	struct plan want = {0};
	struct error error;
	bool good = plan_make(&want, frame, params, &error) == 0 && on_gpu_analyse(engine, frame, params) &&
				engine->report.left_out_count == 0 && same_plan(&engine->plan, &want, totals);
	plan_finish(&want);
	totals->plans++;
	if (!good)
		fprintf(stderr, "in %s\n", what);
	return good;
}
