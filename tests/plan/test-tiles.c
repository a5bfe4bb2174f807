/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The classes of tiles: a picture of 5 x 3 tiles in which each class is at a place known beforehand. */
#include "fixture.h"
#include "tests/test.h"

#define WIDTH 320
#define HEIGHT 192

static void fill(struct fixture *fixture, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, double mx)
{
	for (uint32_t y = y0; y < y1; y++)
		for (uint32_t x = x0; x < x1; x++)
			fixture_set_motion(fixture, x, y, mx, 0.0);
}

static void make(struct plan *plan, struct fixture *fixture)
{
	const struct plan_params params = {.last_phase = 0.5f, .display_width_mm = 10.0f, .viewing_distance_mm = 10000.0f};
	struct error error;
	CHECK_INT(plan_make(plan, &fixture->frame, &params, &error), 0);
}

static void check_sum(const struct plan *plan)
{
	uint32_t counts[PLAN_TILE_CLASSES], sum = 0;
	plan_count_tiles(plan, 0.03f, counts);
	for (int i = 0; i < PLAN_TILE_CLASSES; i++)
		sum += counts[i];
	CHECK_INT(sum, 15);
}

static void test_classes(void)
{
	const struct fixture_spec spec = {.width = WIDTH, .height = HEIGHT, .motion_format = PURSUIT_FORMAT_RG32F};
	struct fixture fixture;
	struct plan plan = {0};
	fixture_make(&fixture, &spec);
	make(&plan, &fixture);
	CHECK_INT(plan_tile_class(&plan, 2, 1, 0.03f), PLAN_TILE_STILL);
	check_sum(&plan);
	fill(&fixture, 0, 0, WIDTH, HEIGHT, 3.0);
	make(&plan, &fixture);
	CHECK_INT(plan_tile_class(&plan, 2, 1, 0.03f), PLAN_TILE_UNIFORM);
	/* The border does not move. */
	CHECK_INT(plan_tile_class(&plan, 0, 1, 0.03f), PLAN_TILE_SMOOTH);
	for (uint32_t x = 0; x < WIDTH; x++)
		fill(&fixture, x, 0, x + 1, HEIGHT, 0.02 * x);
	make(&plan, &fixture);
	CHECK_INT(plan_tile_class(&plan, 2, 1, 0.03f), PLAN_TILE_SMOOTH);
	CHECK_INT(plan_tile_class(&plan, 2, 1, 10.0f), PLAN_TILE_UNIFORM);
	fill(&fixture, 150, 90, 160, 100, 9.0);
	make(&plan, &fixture);
	CHECK_INT(plan_tile_class(&plan, 2, 1, 10.0f), PLAN_TILE_DISCONTINUOUS);
	CHECK_INT(plan_tile_class(&plan, 1, 1, 0.03f), PLAN_TILE_SMOOTH);
	fixture_set_motion(&fixture, 200, 20, (double)NAN, 0.0);
	make(&plan, &fixture);
	CHECK_INT(plan_tile_class(&plan, 3, 0, 0.03f), PLAN_TILE_INVALID);
	CHECK_INT(plan_tile_class(&plan, 2, 1, 0.03f), PLAN_TILE_DISCONTINUOUS);
	check_sum(&plan);
	fixture_set_motion(&fixture, 200, 20, 0.0, 0.0);
	make(&plan, &fixture);
	CHECK(plan.invalid_tiles == NULL);
	plan_finish(&plan);
	fixture_finish(&fixture);
}

static void test_printed(void)
{
	const struct fixture_spec spec = {.width = WIDTH, .height = HEIGHT, .motion_format = PURSUIT_FORMAT_RG16F};
	struct fixture fixture;
	struct plan plan = {0};
	char text[1024] = "";
	fixture_make(&fixture, &spec);
	fill(&fixture, 70, 70, 90, 90, 4.0);
	make(&plan, &fixture);
	FILE *out = fmemopen(text, sizeof(text), "w");
	plan_print(&plan, out);
	fclose(out);
	CHECK(strstr(text,
				 "\"tiles\": {\"still\": 11, \"uniform\": 0, \"smooth\": 0, \"discontinuous\": 4, \"invalid\": 0}"));
	plan_finish(&plan);
	fixture_finish(&fixture);
}

int main(void)
{
	RUN(test_classes);
	RUN(test_printed);
	return test_result();
}
