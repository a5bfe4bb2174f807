/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What must hold of every grid, whatever the motion: order, cells, border, orientation, cover. */
#include "fixture.h"
#include "tests/test.h"

static float twice_area(const struct plan_vertex *a, const struct plan_vertex *b, const struct plan_vertex *c)
{
	return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

static void check_order(const struct plan *plan)
{
	for (uint32_t r = 0; r < plan->rows; r++)
		for (uint32_t c = 0; c < plan->columns; c++) {
			const struct plan_vertex *v = &plan->vertices[r * plan->columns + c];
			CHECK(c + 1 == plan->columns || v[0].x < v[1].x);
			CHECK(r + 1 == plan->rows || v[0].y < v[plan->columns].y);
		}
}

/* In its own cell, or on the edge to the next that belongs to it. */
static void check_cells(const struct plan *plan)
{
	uint32_t snapped = 0;
	for (uint32_t r = 1; r + 1 < plan->rows; r++)
		for (uint32_t c = 1; c + 1 < plan->columns; c++) {
			const struct plan_vertex *v = &plan->vertices[r * plan->columns + c];
			float x0 = (float)((c - 1) * plan->cell), y0 = (float)((r - 1) * plan->cell);
			float x1 = fminf(x0 + (float)plan->cell, (float)plan->width);
			float y1 = fminf(y0 + (float)plan->cell, (float)plan->height);
			CHECK(v->x > x0 && v->x <= x1 && v->x < (float)plan->width);
			CHECK(v->y > y0 && v->y <= y1 && v->y < (float)plan->height);
			CHECK(v->snapped == 1 || (v->snapped == 0 && v->x == (x0 + x1) / 2 && v->y == (y0 + y1) / 2));
			/* On an edge between two pixels: one coordinate whole, the other in the middle. */
			CHECK(v->snapped == 0 || (v->x == floorf(v->x)) != (v->y == floorf(v->y)));
			snapped += v->snapped == 1;
		}
	CHECK_INT(plan->snapped, snapped);
}

static void check_border(const struct plan *plan)
{
	uint32_t columns = plan->columns, rows = plan->rows;
	for (uint32_t r = 0; r < rows; r++)
		for (uint32_t c = 0; c < columns; c++) {
			const struct plan_vertex *v = &plan->vertices[r * columns + c];
			CHECK(v->z >= 0 && v->z <= 1);
			CHECK(fabsf(v->ux) <= 16384 && fabsf(v->uy) <= 16384);
			if (r > 0 && r + 1 < rows && c > 0 && c + 1 < columns)
				continue;
			CHECK(v->ux == 0 && v->uy == 0 && v->snapped == 0);
			CHECK(c > 0 || v->x == 0);
			CHECK(c + 1 < columns || v->x == (float)plan->width);
			CHECK(r > 0 || v->y == 0);
			CHECK(r + 1 < rows || v->y == (float)plan->height);
		}
}

static void check_triangles(const struct plan *plan)
{
	double sum = 0;
	uint32_t vertices = plan->columns * plan->rows;
	CHECK_INT(plan->index_count, 6 * (plan->columns - 1) * (plan->rows - 1));
	for (uint32_t i = 0; i < plan->index_count; i += 3) {
		const uint32_t *index = plan->indices + i;
		CHECK(index[0] < vertices && index[1] < vertices && index[2] < vertices);
		float area = twice_area(&plan->vertices[index[0]], &plan->vertices[index[1]], &plan->vertices[index[2]]);
		CHECK(area > 0);
		sum += (double)area / 2;
	}
	CHECK(sum == (double)plan->width * plan->height);
}

static void check_spec(const struct fixture_spec *spec, uint32_t cell, enum fixture_field field, uint32_t seed)
{
	static struct plan plan;
	struct plan_params params = {.cell = cell, .last_phase = 0.5f, .threshold_quarter = 1, .display_width_mm = 1};
	struct fixture fixture;
	struct error error;
	int failed = test_failed();
	fixture_make(&fixture, spec);
	fixture_fill(&fixture, field, seed);
	CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
	if (plan.rest == PLAN_MOVES) {
		check_order(&plan);
		check_cells(&plan);
		check_border(&plan);
		check_triangles(&plan);
	}
	if (test_failed() != failed)
		fprintf(stderr, "in %u x %u, cell %u, %s, seed %u\n", spec->width, spec->height, cell,
				fixture_field_name(field), seed);
	fixture_finish(&fixture);
}

static void test_random_snaps(void)
{
	for (uint32_t seed = 0; seed < 60; seed++)
		for (uint32_t cell = 4; cell <= 64; cell = cell * 3 / 2) {
			struct fixture_spec spec = {60 + seed, 100 - seed, .motion_format = PURSUIT_FORMAT_RG32F,
										.depth_format = PURSUIT_FORMAT_DEPTH32F};
			check_spec(&spec, cell, FIELD_RANDOM, seed);
			check_spec(&spec, cell, FIELD_SPARSE, seed);
			check_spec(&spec, cell, FIELD_BITS, seed);
		}
}

static void test_all_small_sizes(void)
{
	for (uint32_t w = 1; w <= 18; w++)
		for (uint32_t h = 1; h <= 18; h++)
			for (int field = 0; field < FIELD_COUNT; field++) {
				struct fixture_spec spec = {w, h, .motion_format = PURSUIT_FORMAT_RG32F};
				check_spec(&spec, 4 + (w + h) % 5, (enum fixture_field)field, w * h);
			}
}

/* The vertex snaps to the pixel nearest to the centre, then to the first, and to the nearer side. */
static void test_ties_by_hand(void)
{
	struct fixture_spec spec = {8, 8, .motion_format = PURSUIT_FORMAT_RG32F, .depth_format = PURSUIT_FORMAT_DEPTH32F};
	struct plan_params params = {.display_width_mm = 1};
	struct fixture fixture;
	struct plan plan = {0};
	struct error error;
	fixture_make(&fixture, &spec);
	for (uint32_t y = 0; y < 8; y++)
		for (uint32_t x = 0; x < 8; x++) {
			fixture_set_motion(&fixture, x, y, x < 4 ? 0 : 2, 0);
			fixture_set_depth(&fixture, x, y, x < 4 ? 0.25 : 0.75);
		}
	CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
	const struct plan_vertex *v = &plan.vertices[4];
	CHECK(v->x == 4 && v->y == 3.5f && v->ux == 0 && v->z == 0.25f && v->snapped == 1);
	for (uint32_t y = 0; y < 8; y++)
		for (uint32_t x = 0; x < 8; x++)
			fixture_set_depth(&fixture, x, y, 0.5);
	CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
	CHECK(v->x == 4 && v->y == 3.5f && v->ux == 2 && v->z == 0.5f);
	/* A stronger pixel off the centre wins; of the equal edges around it the first one that is nearest. */
	fixture_set_motion(&fixture, 6, 6, 2, 9);
	CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
	CHECK(v->x == 6.5f && v->y == 6 && v->uy == 9);
	plan_finish(&plan);
	fixture_finish(&fixture);
}

int main(void)
{
	RUN(test_ties_by_hand);
	RUN(test_random_snaps);
	RUN(test_all_small_sizes);
	return test_result();
}
