/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The plan against the oracle: every vertex, every diagonal, every count. */
#include "cases.h"
#include "tests/test.h"

static int differs(double got, double want, double slack)
{
	return !(fabs(got - want) <= slack + 2e-6 * (1 + fabs(want)));
}

static int compare_vertices(const struct oracle *oracle, const struct plan *plan, const char *what)
{
	int wrong = 0;
	for (uint32_t i = 0; i < oracle->columns * oracle->rows; i++) {
		const struct oracle_vertex *want = &oracle->vertices[i];
		const struct plan_vertex *got = &plan->vertices[i];
		double values[6] = {(double)got->x,  (double)got->y, (double)got->ux,
							(double)got->uy, (double)got->z, (double)got->snapped};
		double wants[6] = {want->x, want->y, want->ux, want->uy, want->z, want->snapped};
		int bad = 0;
		for (int k = 0; k < 6; k++)
			bad |= differs(values[k], wants[k], k == 2 || k == 3 ? oracle->slack : 0);
		if (bad && !want->loose && wrong++ < 3)
			fprintf(stderr, "%s: vertex %u: %g %g  %g %g  %g %g, not %g %g  %g %g  %g %g\n", what, i, values[0],
					values[1], values[2], values[3], values[4], values[5], wants[0], wants[1], wants[2], wants[3],
					wants[4], wants[5]);
	}
	return wrong;
}

static int compare_triangles(const struct oracle *oracle, const struct plan *plan, const char *what)
{
	int wrong = 0;
	uint32_t columns = plan->columns;
	for (uint32_t q = 0; q < oracle->quads; q++) {
		const uint32_t *got = plan->indices + 6 * (size_t)q;
		uint32_t v00 = q / (columns - 1) * columns + q % (columns - 1);
		uint32_t v10 = v00 + 1, v01 = v00 + columns, v11 = v01 + 1;
		uint32_t down[6] = {v00, v10, v11, v00, v11, v01}, up[6] = {v00, v10, v01, v10, v11, v01};
		int is_down = memcmp(got, down, sizeof(down)) == 0, is_up = memcmp(got, up, sizeof(up)) == 0;
		uint32_t want = oracle->diagonals[q];
		if (!(is_down && want != 0) && !(is_up && want != 1) && wrong++ < 3)
			fprintf(stderr, "%s: quad %u: %u %u %u %u %u %u\n", what, q, got[0], got[1], got[2], got[3], got[4],
					got[5]);
	}
	return wrong;
}

static void check_counts(const struct oracle *oracle, const struct plan *plan)
{
	CHECK_INT(plan->columns, oracle->columns);
	CHECK_INT(plan->rows, oracle->rows);
	CHECK_INT(plan->index_count, 6 * oracle->quads);
	CHECK_NEAR(plan->snapped, oracle->snapped, oracle->loose);
	CHECK(plan->folded + 6 * oracle->loose >= oracle->folded_least);
	CHECK(plan->folded <= oracle->folded_most + 6 * oracle->loose);
	CHECK(plan->doubtful + 6 * oracle->loose >= oracle->doubtful_least);
	CHECK(plan->doubtful <= oracle->doubtful_most + 6 * oracle->loose);
	CHECK_NEAR(plan->max_displacement, oracle->max_displacement, 1e-5 * (1 + oracle->max_displacement));
}

/* Only where numbers are no quarters may anything hang on the last bits. */
static void check_case(const struct fixture *fixture, const struct plan_params *params, bool exact, const char *what)
{
	static struct plan plan;
	struct oracle oracle;
	struct error error;
	oracle_make(&oracle, fixture, params);
	CHECK_INT(plan_make(&plan, &fixture->frame, params, &error), 0);
	CHECK_INT(plan.rest, oracle.still ? PLAN_STILL : PLAN_MOVES);
	CHECK_INT(plan.invalid_pixels, oracle.invalid);
	CHECK(oracle.loose <= (exact ? 0 : 2 + oracle.columns * oracle.rows / 10));
	if (plan.rest == PLAN_MOVES && plan.columns == oracle.columns && plan.rows == oracle.rows) {
		check_counts(&oracle, &plan);
		int vertices = compare_vertices(&oracle, &plan, what), triangles = compare_triangles(&oracle, &plan, what);
		CHECK_INT(vertices, 0);
		CHECK_INT(triangles, 0);
	} else {
		CHECK_INT(plan.columns, 0);
		CHECK_INT(plan.rows, 0);
		CHECK_INT(plan.index_count, 0);
	}
	oracle_finish(&oracle);
}

static void check_spec(const struct fixture_spec *spec, const struct plan_params *given, enum fixture_field field,
					   uint32_t seed)
{
	/* A tiny display: no speed is beyond tracking, so quarters stay quarters. */
	struct plan_params tiny = *given;
	tiny.display_width_mm = 1;
	const struct plan_params *params = field < FIELD_FLOATS ? &tiny : given;
	struct fixture fixture;
	char what[96];
	int failed = test_failed();
	fixture_make(&fixture, spec);
	fixture_fill(&fixture, field, seed);
	snprintf(what, sizeof(what), "%ux%u %s, motion %u, depth %u/%u, cell %u", spec->width, spec->height,
			 fixture_field_name(field), spec->motion_format, spec->depth_format, spec->depth_kind, params->cell);
	check_case(&fixture, params, field < FIELD_FLOATS, what);
	fixture.frame.volatile_memory = true;
	check_case(&fixture, params, field < FIELD_FLOATS, what);
	if (test_failed() != failed)
		fprintf(stderr, "in %s\n", what);
	fixture_finish(&fixture);
}

static void test_sizes_and_fields(void)
{
	cases_of_sizes(check_spec);
}

static void test_cells(void)
{
	cases_of_cells(check_spec);
}

static void test_depths(void)
{
	cases_of_depths(check_spec);
}

static void test_planes_of_other_sizes(void)
{
	cases_of_planes(check_spec);
}

static void test_still_above_and_below(void)
{
	struct plan_params params = {.last_phase = 0.5f, .display_width_mm = 1};
	for (uint32_t y = 0; y < 40; y++) {
		struct fixture_spec spec = {48, 40, .motion_format = PURSUIT_FORMAT_RG16F,
									.depth_format = PURSUIT_FORMAT_DEPTH32F};
		struct fixture fixture;
		char what[32];
		snprintf(what, sizeof(what), "only row %u", y);
		fixture_make(&fixture, &spec);
		fixture_fill(&fixture, FIELD_STILL, 1);
		for (uint32_t x = 11; x < 30; x++)
			fixture_set_motion(&fixture, x, y, 3, 1);
		check_case(&fixture, &params, true, what);
		fixture_finish(&fixture);
	}
}

int main(void)
{
	RUN(test_sizes_and_fields);
	RUN(test_cells);
	RUN(test_depths);
	RUN(test_planes_of_other_sizes);
	RUN(test_still_above_and_below);
	return test_result();
}
