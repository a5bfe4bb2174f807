/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The analysis on the GPU against that on the CPU: every vertex, triangle and count, on fields of all kinds, formats,
 * sizes, cells, and numbers that are none. The argument is the context: surfaceless, gles, osmesa.
 */
#include "tests/test.h"

#include "daemon/engine/gl/executor_gl.h"
#include "fixture.h"
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
	static const uint32_t sizes[][2] = {{1, 1},  {1, 7},   {7, 1},    {2, 2},  {8, 8},   {9, 9},
										{16, 8}, {17, 25}, {333, 77}, {2, 99}, {129, 65}};
	const struct plan_params params = {.last_phase = 0.5f};
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
		for (int field = 0; field < FIELD_COUNT; field++) {
			struct fixture_spec spec = {sizes[i][0], sizes[i][1], .motion_format = PURSUIT_FORMAT_RG32F,
										.depth_format = PURSUIT_FORMAT_DEPTH32F};
			check_spec(&spec, &params, (enum fixture_field)field, 1 + (uint32_t)i);
			spec.motion_format = PURSUIT_FORMAT_RG16F;
			check_spec(&spec, &params, (enum fixture_field)field, 2 + (uint32_t)i);
		}
}

static void test_cells(void)
{
	static const uint32_t cells[] = {4, 5, 8, 13, 16, 31, 63, 64};
	const struct fixture_spec spec = {203, 131, .motion_format = PURSUIT_FORMAT_RG16F,
									  .depth_format = PURSUIT_FORMAT_DEPTH24};
	for (size_t i = 0; i < sizeof(cells) / sizeof(cells[0]); i++)
		for (uint32_t threshold = 0; threshold <= 63; threshold += 21)
			for (int field = FIELD_SMOOTH; field <= FIELD_SPARSE; field++) {
				const struct plan_params params = {
					.cell = cells[i], .threshold_quarter = threshold, .last_phase = 2.0f / 3};
				check_spec(&spec, &params, (enum fixture_field)field, 50 + threshold);
			}
}

static void test_depths(void)
{
	static const uint32_t formats[] = {0, PURSUIT_FORMAT_DEPTH16, PURSUIT_FORMAT_DEPTH24, PURSUIT_FORMAT_DEPTH32F};
	static const struct {
		uint32_t kind;
		float near_distance, far_distance;
	} kinds[] = {{PURSUIT_DEPTH_DEVICE, 0, 0},           {PURSUIT_DEPTH_DEVICE_REVERSED, 0, 0},
				 {PURSUIT_DEPTH_LINEAR, 0.125f, 0.875f}, {PURSUIT_DEPTH_LINEAR, 0.125f, INFINITY},
				 {PURSUIT_DEPTH_LINEAR, 0, 0},           {PURSUIT_DEPTH_LINEAR, 0.5f, 0}};
	const struct plan_params params = {.last_phase = 0.5f};
	for (size_t f = 0; f < 4; f++)
		for (size_t k = 0; k < sizeof(kinds) / sizeof(kinds[0]); k++)
			for (int field = FIELD_LAYERS; field <= FIELD_BITS; field++) {
				const struct fixture_spec spec = {93,
												  61,
												  .motion_format = PURSUIT_FORMAT_RG32F,
												  .depth_format = formats[f],
												  .depth_kind = kinds[k].kind,
												  .near_distance = kinds[k].near_distance,
												  .far_distance = kinds[k].far_distance};
				check_spec(&spec, &params, (enum fixture_field)field, 9);
			}
}

static void test_geometry_of_another_size(void)
{
	static const uint32_t others[][4] = {{160, 90, 80, 45},  {161, 91, 80, 45}, {80, 45, 160, 90},
										 {100, 60, 100, 30}, {97, 61, 1, 1},    {97, 61, 31, 97}};
	const struct plan_params params = {.last_phase = 0.5f};
	for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
		for (int field = FIELD_CONSTANT; field <= FIELD_BITS; field++) {
			const uint32_t *o = others[i];
			const struct fixture_spec spec = {o[0], o[1], PURSUIT_FORMAT_RG16F, o[2], o[3], PURSUIT_FORMAT_DEPTH16,
											  o[0], o[3]};
			check_spec(&spec, &params, (enum fixture_field)field, 77);
		}
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
	RUN(test_geometry_of_another_size);
	RUN(test_what_is_no_number);
	RUN(test_too_large);
	printf("%llu plans, %llu of %llu vertices equal to the bit\n", (unsigned long long)totals.plans,
		   (unsigned long long)totals.equal, (unsigned long long)totals.vertices);
	engine_destroy(&engine);
	return test_result();
}
