/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The analysis on the GPU against that on the CPU: every vertex, triangle and count, on fields of all kinds, formats,
 * sizes, cells, and numbers that are none. The argument is the context: surfaceless, gles, osmesa.
 */
#include "tests/test.h"

#include "cases.h"
#include "daemon/engine/gl/executor_gl.h"
#include "on-gpu.h"

static struct engine *engine;
static struct on_gpu_totals totals;

static void check(const struct fixture *fixture, const struct plan_params *params, const char *what)
{
	CHECK(on_gpu_alike(engine, &fixture->frame, params, what, &totals));
}

static void check_spec(const struct fixture_spec *spec, const struct plan_params *params, enum fixture_field field,
					   uint32_t seed)
{
	struct fixture fixture;
	char what[96];
	fixture_make(&fixture, spec);
	fixture_fill(&fixture, field, seed);
	fixture.frame.header.motion_interval_ns = 24000000;
	snprintf(what, sizeof(what), "%ux%u %s, motion %u, depth %u/%u, cell %u", spec->width, spec->height,
			 fixture_field_name(field), spec->motion_format, spec->depth_format, spec->depth_kind, params->cell);
	check(&fixture, params, what);
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

/* Infinite and huge numbers, one and all: marked where they are. */
static void test_what_is_no_number(void)
{
	static const uint32_t words[] = {0x7f800000, 0xff800000, 0x7fc00000, 0x7f800001,
									 0xffffffff, 0x7f7fffff, 0xff7fffff};
	const struct fixture_spec spec = {200, 150, .motion_format = PURSUIT_FORMAT_RG32F,
									  .depth_format = PURSUIT_FORMAT_DEPTH32F};
	const struct plan_params params = {.last_phase = 0.5f, .display_width_mm = 1};
	for (size_t k = 0; k < sizeof(words) / sizeof(words[0]); k++) {
		struct fixture fixture;
		fixture_make(&fixture, &spec);
		fixture_fill(&fixture, FIELD_LAYERS, 1);
		for (uint32_t i = 70; i < 90; i++)
			fixture_set_motion_bits(&fixture, i, i, k % 2 ? words[k] : 0x3f800000, words[k]);
		check(&fixture, &params, "some of them");
		CHECK_INT(engine->plan.invalid_pixels, k < 5 ? 20 : 0);
		for (uint32_t y = 0; y < 150; y++)
			for (uint32_t x = 0; x < 200; x++)
				fixture_set_motion_bits(&fixture, x, y, words[k], words[k]);
		check(&fixture, &params, "all of them");
		fixture_finish(&fixture);
	}
}

static void test_rests(void)
{
	const struct fixture_spec spec = {64, 48, .motion_format = PURSUIT_FORMAT_RG16F};
	const struct plan_params params = {.last_phase = 0.5f};
	struct fixture fixture;
	fixture_make(&fixture, &spec);
	check(&fixture, &params, "still");
	fixture_fill(&fixture, FIELD_LAYERS, 1);
	check(&fixture, &params, "without depth");
	fixture.frame.header.flags = PURSUIT_FRAME_CUT;
	check(&fixture, &params, "cut");
	CHECK_INT(engine->plan.rest, PLAN_CUT);
	fixture_finish(&fixture);
}

static void check_left_to_the_cpu(const struct fixture *fixture)
{
	const struct plan_params params = {.last_phase = 0.5f};
	CHECK(on_gpu_analyse(engine, &fixture->frame, &params));
	CHECK_INT(engine->report.left_out_count, 1);
	CHECK_STRING(engine->report.left_out[0].name, "gpu-analysis");
	CHECK_STRING(engine->report.left_out[0].reason, "size");
	CHECK(engine->plan.rest == PLAN_MOVES && engine->plan.snapped > 0);
}

/* What this renderer cannot take is the CPU's, and the report says so: a plane, or the vertices. */
static void test_too_large(void)
{
	const struct fixture_spec spec = {64, 48, .motion_format = PURSUIT_FORMAT_RG16F};
	struct gl *gl = &gl_of(engine)->context->gl;
	const uint32_t size = engine->executor->max_size;
	const int storage = gl->max_storage;
	struct fixture fixture;
	fixture_make(&fixture, &spec);
	fixture_fill(&fixture, FIELD_LAYERS, 1);
	engine->executor->max_size = 63;
	check_left_to_the_cpu(&fixture);
	engine->executor->max_size = size;
	gl->max_storage = 1900;
	check_left_to_the_cpu(&fixture);
	gl->max_storage = storage;
	CHECK(storage >= 1 << 27);
	fixture_finish(&fixture);
}

int main(int argc, char **argv)
{
	struct error error = {""};
	engine = on_gpu_open(argc > 1 ? argv[1] : "surfaceless", &error);
	if (!engine)
		SKIP(error.text);
	printf("%s, %s\n", engine_get_info(engine)->renderer, engine_get_info(engine)->version);
	RUN(test_rests);
	RUN(test_sizes_and_fields);
	RUN(test_cells);
	RUN(test_depths);
	RUN(test_planes_of_other_sizes);
	RUN(test_what_is_no_number);
	RUN(test_too_large);
	printf("%llu plans, %llu of %llu vertices equal to the bit\n", (unsigned long long)totals.plans,
		   (unsigned long long)totals.equal, (unsigned long long)totals.vertices);
	engine_destroy(&engine);
	return test_result();
}
