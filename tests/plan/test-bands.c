/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* However many threads share the rows of a frame, the plan is the same to the bit. */
#include "daemon/engine/pool.h"
#include "fixture.h"
#include "tests/test.h"

static struct pool *pools[3]; /* of 2, 3 and 8 threads */

static void check(const struct fixture *fixture, struct plan_params params, const char *what)
{
	static struct plan alone, shared;
	struct error error;
	params.pool = NULL;
	CHECK_INT(plan_make(&alone, &fixture->frame, &params, &error), 0);
	for (int i = 0; i < 3; i++) {
		params.pool = pools[i];
		CHECK_INT(plan_make(&shared, &fixture->frame, &params, &error), 0);
		bool same = fixture_same_plan(&alone, &shared);
		CHECK(same);
		if (!same)
			fprintf(stderr, "%s, cells of %u: %u threads make another plan\n", what, params.cell,
					pool_threads(pools[i]));
	}
}

static void check_all_cells(const struct fixture *fixture, const char *what)
{
	static const uint32_t cells[] = {4, 8, 11, 64};
	for (size_t i = 0; i < sizeof(cells) / sizeof(cells[0]); i++)
		check(fixture, (struct plan_params){.last_phase = 0.75f, .cell = cells[i]}, what);
}

static void test_fields(void)
{
	static const uint32_t heights[] = {1, 40, 77, 333, 700};
	for (size_t h = 0; h < sizeof(heights) / sizeof(heights[0]); h++)
		for (int field = 0; field < FIELD_COUNT; field++) {
			struct fixture_spec spec = {.width = 93,
										.height = heights[h],
										.motion_format = h % 2 ? PURSUIT_FORMAT_RG16F : PURSUIT_FORMAT_RG32F,
										.depth_format = PURSUIT_FORMAT_DEPTH32F};
			struct fixture fixture;
			fixture_make(&fixture, &spec);
			fixture_fill(&fixture, (enum fixture_field)field, 5 + field);
			fixture.frame.volatile_memory = field % 2;
			check_all_cells(&fixture, fixture_field_name((enum fixture_field)field));
			fixture_finish(&fixture);
		}
}

/* One row that moves, anywhere: the bands before and after it are still. */
static void test_one_row(void)
{
	const struct fixture_spec spec = {
		.width = 50, .height = 400, .motion_format = PURSUIT_FORMAT_RG32F, .depth_format = PURSUIT_FORMAT_DEPTH16};
	for (uint32_t row = 0; row < spec.height; row += 7) {
		struct fixture fixture;
		fixture_make(&fixture, &spec);
		for (uint32_t x = 10; x < 30; x++)
			fixture_set_motion(&fixture, x, row, 3.5, -1.0);
		check_all_cells(&fixture, "one row");
		fixture_finish(&fixture);
	}
}

/* Each pixel that is no number is counted once, also in rows that two bands look at. */
static void test_invalid(void)
{
	const struct fixture_spec spec = {.width = 200, .height = 500, .motion_format = PURSUIT_FORMAT_RG32F};
	struct fixture fixture;
	struct plan plan = {0};
	struct error error;
	fixture_make(&fixture, &spec);
	fixture_fill(&fixture, FIELD_SMOOTH, 1);
	for (uint32_t y = 0; y < spec.height; y++)
		fixture_set_motion(&fixture, y % 200, y, (double)NAN, 0.0);
	check_all_cells(&fixture, "invalid");
	const struct plan_params params = {.last_phase = 0.5f, .pool = pools[2]};
	CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
	CHECK_INT((long)plan.invalid_pixels, 500);
	plan_finish(&plan);
	fixture_finish(&fixture);
}

int main(void)
{
	static const uint32_t threads[3] = {2, 3, POOL_MAX_THREADS};
	for (int i = 0; i < 3; i++)
		pools[i] = pool_create(threads[i]);
	RUN(test_fields);
	RUN(test_one_row);
	RUN(test_invalid);
	for (int i = 0; i < 3; i++)
		pool_destroy(&pools[i]);
	return test_result();
}
