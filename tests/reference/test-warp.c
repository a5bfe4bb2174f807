/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The warp of the reference (docs/method.md, 3) and what it displays (7). */
#include "input.h"
#include "reference.h"
#include "tests/test.h"

static const struct engine_begin_params two = {.n = 2, .last_phase = -1.0};

static void begin(struct reference *reference, struct input *input, const struct input_spec *spec,
				  const struct engine_params *params)
{
	struct engine_params mine = *params;
	mine.display_width_mm = input_display_mm(spec->width);
	input_make(input, spec);
	reference_begin(reference, &input->frame, &mine, &two);
}

static void test_identity_without_phase(void)
{
	static const enum input_field fields[] = {INPUT_SMOOTH, INPUT_LAYERS, INPUT_VIOLENT, INPUT_BROKEN};
	for (int f = 0; f < 4; f++) {
		const struct input_spec spec = {.width = 53, .height = 38, .field = fields[f], .image = INPUT_NOISE, .seed = 5};
		const struct engine_params params = {.blur = ENGINE_BLUR_OFF};
		const struct engine_request request = {ENGINE_SHOW_IN_BETWEEN, 0.0};
		static uint8_t pixels[53 * 38 * 4];
		struct reference reference = {0};
		struct input input;
		begin(&reference, &input, &spec, &params);
		reference_render(&reference, &request, pixels);
		for (size_t i = 0; i < sizeof(pixels); i++)
			CHECK_INT(pixels[i], reference.original.data[i]);
		reference_finish(&reference);
		input_finish(&input);
	}
}

/* (3, -2) a real frame: at phase 1 inner pixels show what was 3 left and 2 below. */
static void test_integer_translation(void)
{
	const struct input_spec spec = {
		.width = 72, .height = 48, .field = INPUT_TRANSLATE, .image = INPUT_NOISE, .seed = 3};
	const struct engine_params params = {.blur = ENGINE_BLUR_OFF};
	const struct engine_request request = {ENGINE_SHOW_IN_BETWEEN, 1.0};
	static uint8_t pixels[72 * 48 * 4];
	struct reference reference = {0};
	struct input input;
	begin(&reference, &input, &spec, &params);
	reference_render(&reference, &request, pixels);
	/* Interior vertices begin half a cell in; they have moved by the whole. */
	for (int j = 8; j < 40; j++)
		for (int i = 8; i < 64; i++)
			for (int c = 0; c < 3; c++)
				CHECK_INT(pixels[(j * 72 + i) * 4 + c], reference.original.data[((j + 2) * 72 + i - 3) * 4 + c]);
	reference_finish(&reference);
	input_finish(&input);
}

static void check_cover(uint32_t width, uint32_t height, uint32_t cell, enum input_field field, uint64_t seed)
{
	static const double phases[] = {-1.0, -0.3, 0.0, 0.02, 0.3, 0.5, 1.0, 2.7, 8.0};
	const struct input_spec spec = {.width = width, .height = height, .field = field, .seed = seed};
	const struct engine_params params = {.cell = cell};
	struct reference_hit *hits = reference_alloc((size_t)width * height, sizeof(*hits));
	struct reference reference = {0};
	struct input input;
	begin(&reference, &input, &spec, &params);
	for (size_t p = 0; p < sizeof(phases) / sizeof(phases[0]); p++) {
		size_t bare = 0, outside = 0;
		reference_warp(&reference.grid, width, height, phases[p], hits);
		for (size_t i = 0; i < (size_t)width * height; i++) {
			bare += hits[i].triangle < 0;
			outside += !(hits[i].x >= 0.0 && hits[i].x <= width && hits[i].y >= 0.0 && hits[i].y <= height);
		}
		CHECK_INT(bare, 0);
		CHECK_INT(outside, 0);
	}
	reference_finish(&reference);
	input_finish(&input);
	free(hits);
}

static void test_full_coverage(void)
{
	for (uint32_t seed = 1; seed <= 6; seed++) {
		check_cover(61, 43, 8, INPUT_VIOLENT, seed);
		check_cover(40, 64, 4, INPUT_SHAKE, seed);
		check_cover(37, 29, 16, INPUT_BROKEN, seed);
		check_cover(64, 40, 8, INPUT_LAYERS, seed);
		check_cover(1 + seed, 7 - seed, 4, INPUT_VIOLENT, seed);
	}
	check_cover(1, 1, 8, INPUT_TRANSLATE, 1);
	check_cover(2, 1, 8, INPUT_VIOLENT, 1);
}

/* Two triangles over one place: the nearer shows, and of equals the first. */
static void test_nearest_wins(void)
{
	struct reference_vertex vertices[6] = {
		{.x = 0, .y = 0, .z = 0.6},
		{.x = 8, .y = 0, .z = 0.6},
		{.x = 0, .y = 8, .z = 0.6},
		{.x = 8, .y = 0, .ux = -8, .z = 0.4},
		{.x = 16, .y = 0, .ux = -8, .z = 0.4},
		{.x = 8, .y = 8, .ux = -8, .z = 0.4},
	};
	struct reference_triangle triangles[2] = {{{0, 1, 2}, false}, {{3, 4, 5}, false}};
	const struct reference_grid grid = {.vertices = vertices, .triangle_count = 2, .triangles = triangles};
	struct reference_hit hits[16 * 8];
	reference_warp(&grid, 16, 8, 1.0, hits);
	CHECK_INT(hits[16 + 1].triangle, 1);
	CHECK_NEAR(hits[16 + 1].x, 9.5, 1e-12);
	CHECK_NEAR(hits[16 + 1].y, 1.5, 1e-12);
	CHECK_NEAR(hits[16 + 1].z, 0.4, 1e-12);
	CHECK_INT(hits[7 * 16 + 15].triangle, -1);
	for (int i = 3; i < 6; i++)
		vertices[i].z = 0.6;
	reference_warp(&grid, 16, 8, 1.0, hits);
	CHECK_INT(hits[16 + 1].triangle, 0);
	for (int i = 3; i < 6; i++)
		vertices[i].z = 0.9;
	reference_warp(&grid, 16, 8, 1.0, hits);
	CHECK_INT(hits[16 + 1].triangle, 0);
	/* Turned over: not drawn, though nearest. */
	for (int i = 3; i < 6; i++)
		vertices[i].z = 0.1;
	vertices[4].ux = -18.0;
	reference_warp(&grid, 16, 8, 1.0, hits);
	CHECK_INT(hits[16 + 1].triangle, 0);
}

static void test_depth_is_interpolated(void)
{
	struct reference_vertex vertices[3] = {
		{.x = 0, .y = 0, .z = 0.0}, {.x = 8, .y = 0, .z = 0.8}, {.x = 0, .y = 8, .z = 0.4}};
	struct reference_triangle triangle = {{0, 1, 2}, false};
	const struct reference_grid grid = {.vertices = vertices, .triangle_count = 1, .triangles = &triangle};
	struct reference_hit hits[64];
	reference_warp(&grid, 8, 8, 0.0, hits);
	CHECK_NEAR(hits[8 * 1 + 2].z, 0.1 * 2.5 + 0.05 * 1.5, 1e-12);
}

static void test_bilinear(void)
{
	uint8_t data[] = {0, 10, 20, 0, 100, 20, 20, 0, 50, 30, 20, 0, 250, 40, 20, 0};
	const struct reference_picture picture = {2, 2, data};
	double out[3];
	reference_sample(&picture, 1.0, 1.0, out);
	CHECK_NEAR(out[0], 100.0, 1e-12);
	CHECK_NEAR(out[1], 25.0, 1e-12);
	reference_sample(&picture, 0.75, 0.5, out);
	CHECK_NEAR(out[0], 25.0, 1e-12);
	reference_sample(&picture, 0.0, 2.0, out);
	CHECK_NEAR(out[0], 50.0, 1e-12);
}

/* What is shown undisplaced, and by which plane. */
static void test_which_plane_shows(void)
{
	const struct input_spec spec = {.width = 40, .height = 30, .field = INPUT_LAYERS, .image = INPUT_EDGES, .seed = 2};
	const struct engine_params params = {.blur = ENGINE_BLUR_EVERYWHERE};
	static uint8_t pixels[40 * 30 * 4];
	struct reference reference = {0};
	struct input input;
	begin(&reference, &input, &spec, &params);
	CHECK(memcmp(reference.original.data, reference.real.data, sizeof(pixels)) != 0);
	CHECK(memcmp(reference.between.data, reference.real.data, sizeof(pixels)) != 0);
	reference_render(&reference, &(struct engine_request){ENGINE_SHOW_REAL, 0.05}, pixels);
	CHECK(memcmp(pixels, reference.real.data, sizeof(pixels)) == 0);
	reference_render(&reference, &(struct engine_request){ENGINE_SHOW_REAL, (double)NAN}, pixels);
	CHECK(memcmp(pixels, reference.real.data, sizeof(pixels)) == 0);
	reference_render(&reference, &(struct engine_request){ENGINE_SHOW_REAL, -0.06}, pixels);
	CHECK(memcmp(pixels, reference.real.data, sizeof(pixels)) != 0);
	reference_render(&reference, &(struct engine_request){ENGINE_SHOW_PLAIN, 0.7}, pixels);
	CHECK(memcmp(pixels, reference.original.data, sizeof(pixels)) == 0);
	reference_finish(&reference);
	input_finish(&input);
}

static void test_ui_comes_last(void)
{
	const struct input_spec spec = {.width = 40,
									.height = 30,
									.field = INPUT_VIOLENT,
									.image = INPUT_NOISE,
									.seed = 2,
									.ui_format = PURSUIT_FORMAT_RGBA8};
	const struct engine_params params = {0};
	static uint8_t pixels[40 * 30 * 4];
	struct reference reference = {0};
	struct input input;
	begin(&reference, &input, &spec, &params);
	reference_render(&reference, &(struct engine_request){ENGINE_SHOW_IN_BETWEEN, 0.5}, pixels);
	for (int i = 0; i < 40 * 5; i++) /* opaque at the top */
		for (int c = 0; c < 3; c++)
			CHECK_INT(pixels[i * 4 + c], reference.ui.data[i * 4 + c]);
	CHECK_NEAR(reference_over(0.2, 0.25, 0.8), 0.8, 1e-12);
	CHECK_NEAR(reference_over(0.7, 0.0, 0.8), 1.0, 0.0);
	reference_finish(&reference);
	input_finish(&input);
}

int main(void)
{
	RUN(test_identity_without_phase);
	RUN(test_integer_translation);
	RUN(test_full_coverage);
	RUN(test_nearest_wins);
	RUN(test_depth_is_interpolated);
	RUN(test_bilinear);
	RUN(test_which_plane_shows);
	RUN(test_ui_comes_last);
	return test_result();
}
