/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Displacement by hand: damping, intervals, clamps, what is no number, rests, printing. */
#include "fixture.h"
#include "tests/test.h"

#define W 64u
#define H 48u

static struct plan plan;

/* One pixel is one degree per second: atan(1) / 45 of a display W pixels wide at that distance, T = S = 1 s. */
static struct plan_params one_degree(void)
{
	return (struct plan_params){
		.last_phase = 0.5f, .display_width_mm = (float)(W * tan(acos(-1) / 180)), .viewing_distance_mm = 1};
}

static void make(struct fixture *fixture, uint32_t format)
{
	struct fixture_spec spec = {W, H, .motion_format = format};
	fixture_make(fixture, &spec);
	fixture->frame.header.real_interval_ns = 1000000000;
}

static void fill(struct fixture *fixture, double x, double y)
{
	for (uint32_t j = 0; j < H; j++)
		for (uint32_t i = 0; i < W; i++)
			fixture_set_motion(fixture, i, j, x, y);
}

static const struct plan_vertex *shown(const struct fixture *fixture, const struct plan_params *params)
{
	struct error error;
	CHECK_INT(plan_make(&plan, &fixture->frame, params, &error), 0);
	return plan.rest == PLAN_MOVES ? &plan.vertices[plan.columns + 1] : NULL;
}

static void check_damped(double speed, double factor)
{
	struct plan_params params = one_degree();
	struct fixture fixture;
	make(&fixture, PURSUIT_FORMAT_RG32F);
	fill(&fixture, 0.6 * speed, -0.8 * speed);
	const struct plan_vertex *v = shown(&fixture, &params);
	CHECK((v == NULL) == (factor == 0));
	if (v) {
		CHECK_NEAR(v->ux, 0.6 * speed * factor, 2e-4);
		CHECK_NEAR(v->uy, -0.8 * speed * factor, 2e-4);
		CHECK_NEAR(plan.max_displacement, speed * factor, 2e-4);
	}
	fixture_finish(&fixture);
}

static void test_damping_by_hand(void)
{
	check_damped(10, 1);
	check_damped(69.9, 1);
	check_damped(70, 1);
	check_damped(75, 1 - 0.15625); /* t = 1/4: 3/16 - 2/64 */
	check_damped(80, 0.5);
	check_damped(85, 0.15625);
	check_damped(90.001, 0);
	check_damped(5000, 0);
}

/* Speed is measured over S, whatever T is. */
static void test_intervals(void)
{
	struct plan_params params = one_degree();
	struct fixture fixture;
	make(&fixture, PURSUIT_FORMAT_RG16F);
	struct pursuit_frame_header *header = &fixture.frame.header;
	fill(&fixture, 40, 0);
	header->motion_interval_ns = 500000000;
	CHECK_NEAR(shown(&fixture, &params)->ux, 40 * 2 * 0.5, 1e-3); /* 80 degrees/s, two S */
	CHECK_NEAR(plan.real_interval_s, 1, 1e-12);
	params.real_interval_ns = 250000000;
	CHECK_NEAR(shown(&fixture, &params)->ux, 40 * 0.5 * 0.5, 1e-3);
	CHECK_NEAR(plan.real_interval_s, 0.25, 1e-12);
	header->motion_interval_ns = 0; /* then motion spans the frame's own interval */
	CHECK_NEAR(shown(&fixture, &params)->ux, 40 * 0.25, 1e-3);
	header->real_interval_ns = 0;
	params.real_interval_ns = 1000000000;
	CHECK_NEAR(shown(&fixture, &params)->ux, 40, 1e-3);
	params.real_interval_ns = 0;
	header->motion_interval_ns = 1000000000;
	CHECK_NEAR(shown(&fixture, &params)->ux, 40, 1e-3);
	CHECK_NEAR(plan.real_interval_s, 1, 1e-12);
	params.real_interval_ns = UINT64_MAX; /* T / S is at most 8 */
	CHECK_NEAR(shown(&fixture, &params)->ux, 320, 1e-3);
	params.real_interval_ns = 1;
	CHECK_NEAR(shown(&fixture, &params)->ux, 5, 1e-3);
	fixture_finish(&fixture);
}

static void test_clamps(void)
{
	struct plan_params params = {.display_width_mm = 1e-6f}; /* nothing is too fast */
	struct fixture fixture;
	make(&fixture, PURSUIT_FORMAT_RG32F);
	struct pursuit_frame_header *header = &fixture.frame.header;
	header->motion_interval_ns = 8 * header->real_interval_ns;
	fill(&fixture, 1e30, -65504);
	const struct plan_vertex *v = shown(&fixture, &params);
	CHECK(v->ux == 8188 && v->uy == -8188);
	header->motion_interval_ns = header->real_interval_ns / 4;
	v = shown(&fixture, &params);
	CHECK(v->ux == 16384 && v->uy == -16384);
	fill(&fixture, 4096, 0.125);
	v = shown(&fixture, &params);
	CHECK(v->ux == 16384 && v->uy == 0.5f);
	fixture_finish(&fixture);
}

static void test_what_is_no_number(void)
{
	static const uint32_t halves[] = {0x7c00, 0xfc00, 0x7e00, 0x7c01, 0xffff};
	static const uint32_t singles[] = {0x7f800000, 0xff800000, 0x7fc00000, 0x7f800001, 0xffffffff};
	struct plan_params params = {.last_phase = 0.5f, .display_width_mm = 1};
	for (uint32_t format = PURSUIT_FORMAT_RG16F; format <= PURSUIT_FORMAT_RG32F; format++)
		for (uint32_t k = 0; k < 10; k++) {
			struct fixture fixture;
			make(&fixture, format);
			fill(&fixture, 3, 1);
			uint32_t bits = format == PURSUIT_FORMAT_RG16F ? halves[k / 2] : singles[k / 2];
			for (uint32_t i = 8; i < 16; i++)
				for (uint32_t j = 0; j < 8; j++)
					fixture_set_motion_bits(&fixture, i, j, k % 2 ? bits : 0, k % 2 ? 0x3c00 : bits);
			const struct plan_vertex *v = shown(&fixture, &params);
			CHECK_INT(plan.invalid_pixels, 64);
			CHECK(v[0].ux == 3 && v[0].uy == 1 && v[2].ux == 3);
			/* The silhouette of what does not move: a snapped vertex with the larger displacement. */
			CHECK(v[1].snapped == 1 && v[1].ux == 3);
			fixture_finish(&fixture);
		}
}

static void test_all_invalid_is_still(void)
{
	struct plan_params params = {0};
	struct fixture fixture;
	make(&fixture, PURSUIT_FORMAT_RG16F);
	fill(&fixture, (double)NAN, 1);
	CHECK(!shown(&fixture, &params));
	CHECK_INT(plan.rest, PLAN_STILL);
	CHECK_INT(plan.invalid_pixels, W * H);
	fixture_finish(&fixture);
}

static void test_denormals_and_signs_of_zero(void)
{
	struct plan_params params = {0};
	struct fixture fixture;
	make(&fixture, PURSUIT_FORMAT_RG32F);
	for (uint32_t j = 0; j < H; j++)
		for (uint32_t i = 0; i < W; i++)
			fixture_set_motion_bits(&fixture, i, j, 0x80000000, 0);
	CHECK(!shown(&fixture, &params));
	CHECK_INT(plan.rest, PLAN_STILL);
	fixture_set_motion_bits(&fixture, 40, 40, 1, 0x80000001);
	CHECK(shown(&fixture, &params) != NULL);
	CHECK(plan.snapped == 0 && plan.max_displacement < 1e-30f && plan.folded == 0 && plan.doubtful == 0);
	fixture.frame.header.motion_interval_ns = 8 * fixture.frame.header.real_interval_ns;
	CHECK(!shown(&fixture, &params));
	fixture_finish(&fixture);
}

static void check_rest(struct fixture *fixture, enum plan_rest rest, const char *name)
{
	struct plan_params params = {.last_phase = 0.5f};
	struct error error;
	CHECK_INT(plan_make(&plan, &fixture->frame, &params, &error), 0);
	CHECK_INT(plan.rest, rest);
	CHECK_STRING(plan_rest_name(plan.rest), name);
	CHECK_INT(plan.frame_id, 7);
	CHECK(plan.width == W && plan.height == H);
	CHECK(rest == PLAN_MOVES || (plan.columns == 0 && plan.rows == 0 && plan.index_count == 0 && plan.snapped == 0));
	CHECK(rest == PLAN_MOVES || (plan.folded == 0 && plan.doubtful == 0 && plan.max_displacement == 0));
}

static void test_rests(void)
{
	struct fixture fixture;
	make(&fixture, PURSUIT_FORMAT_RG16F);
	struct pursuit_frame_header *header = &fixture.frame.header;
	check_rest(&fixture, PLAN_STILL, "still");
	fill(&fixture, 2, 2);
	check_rest(&fixture, PLAN_MOVES, "");
	header->flags = PURSUIT_FRAME_CUT | PURSUIT_FRAME_MOTION_INVALID;
	check_rest(&fixture, PLAN_CUT, "cut");
	header->flags = PURSUIT_FRAME_MOTION_INVALID;
	check_rest(&fixture, PLAN_MOTION_INVALID, "motion-invalid");
	header->flags = 0;
	header->real_interval_ns = 0;
	check_rest(&fixture, PLAN_NO_INTERVAL, "no-interval");
	header->motion_interval_ns = 1000000000;
	check_rest(&fixture, PLAN_MOVES, "");
	header->planes[1].role = 77;
	check_rest(&fixture, PLAN_NO_MOTION, "no-motion");
	fixture_finish(&fixture);
}

static void test_absurd_params(void)
{
	static const float odd[] = {NAN, INFINITY, -1, 0, 1e38f, 1e-38f};
	struct fixture fixture;
	make(&fixture, PURSUIT_FORMAT_RG32F);
	fixture_fill(&fixture, FIELD_BITS, 4);
	for (int a = 0; a < 6; a++)
		for (int b = 0; b < 6; b++)
			for (int c = 0; c < 6; c++) {
				struct plan_params params = {.display_width_mm = odd[a],
											 .viewing_distance_mm = odd[b],
											 .last_phase = odd[c],
											 .cell = a ? UINT32_MAX : 1,
											 .threshold_quarter = UINT32_MAX};
				struct error error;
				CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
				CHECK(plan.cell == (a ? 64 : 4) && plan.last_phase >= 0 && plan.last_phase <= 8);
				for (uint32_t i = 0; i < plan.columns * plan.rows; i++)
					CHECK(fabsf(plan.vertices[i].ux) <= 16384 && fabsf(plan.vertices[i].uy) <= 16384);
			}
	fixture_finish(&fixture);
}

/* What is stretched to twice its width is doubtful, what is pressed to nothing at the border is folded. */
static void test_counts_by_hand(void)
{
	struct plan_params params = {.display_width_mm = 1, .last_phase = 1};
	struct fixture fixture;
	make(&fixture, PURSUIT_FORMAT_RG32F);
	for (uint32_t j = 0; j < H; j++)
		for (uint32_t i = 0; i < W; i++)
			fixture_set_motion(&fixture, i, j, i < 32 ? 0 : 8, 0);
	params.threshold_quarter = 63; /* 8 pixels are 32 quarters: nothing snaps */
	shown(&fixture, &params);
	CHECK_INT(plan.snapped, 0);
	/* The quads between the two columns that part, the outer rows left aside. */
	uint32_t inner = 2 * (H / 8 - 1);
	CHECK(plan.doubtful >= inner && plan.folded > 0);
	params.last_phase = 0.26f; /* 8 to 10.08 pixels: a stretch of 1.26 */
	shown(&fixture, &params);
	CHECK(plan.doubtful >= inner && plan.folded == 0);
	params.last_phase = 0.14f; /* 1.14, and with the shear at the upper border 1.23 */
	shown(&fixture, &params);
	CHECK(plan.doubtful == 0 && plan.folded == 0);
	params.last_phase = 0;
	shown(&fixture, &params);
	CHECK(plan.doubtful == 0 && plan.folded == 0);
	fixture_finish(&fixture);
}

static void test_print(void)
{
	char *text = NULL;
	size_t size;
	struct fixture fixture;
	make(&fixture, PURSUIT_FORMAT_RG16F);
	check_rest(&fixture, PLAN_STILL, "still");
	FILE *out = open_memstream(&text, &size);
	plan_print(&plan, out);
	fclose(out);
	CHECK(text[0] == '{' && strcmp(text + size - 2, "}\n") == 0 && strchr(text, '\n') == text + size - 1);
	CHECK(strstr(text, "\"rest\": \"still\"") && strstr(text, "\"frame\": 7,") && strstr(text, "\"vertices\": 0,"));
	free(text);
	fixture_finish(&fixture);
}

int main(void)
{
	RUN(test_damping_by_hand);
	RUN(test_intervals);
	RUN(test_clamps);
	RUN(test_what_is_no_number);
	RUN(test_all_invalid_is_still);
	RUN(test_denormals_and_signs_of_zero);
	RUN(test_rests);
	RUN(test_absurd_params);
	RUN(test_counts_by_hand);
	RUN(test_print);
	plan_finish(&plan);
	return test_result();
}
