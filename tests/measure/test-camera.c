/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The pursuit camera and the energy error against cases worked out by hand. */
#include <math.h>

#include "canvas.h"
#include "daemon/measure/camera.h"
#include "daemon/measure/energy.h"
#include "tests/test.h"

#define W 64u
#define H 16u
#define STEPS 16

static float before[2 * W * H], after[2 * W * H];
static light_pixel light[W * H], seen[W * H];
static const struct camera_path path = {W, H, before, after};

/* All pixels move right by `pixels` in the window. */
static void set_motion(float pixels)
{
	memset(before, 0, sizeof(before));
	memset(after, 0, sizeof(after));
	for (uint32_t i = 0; i < W * H; i++) {
		before[2 * i] = -pixels / 2.0f;
		after[2 * i] = pixels / 2.0f;
	}
}

/* A bright column of light 1. */
static void set_column(uint32_t x)
{
	memset(light, 0, sizeof(light));
	for (uint32_t y = 0; y < H; y++)
		light[y * W + x] = (light_pixel){1.0f, 1.0f, 1.0f, 0.0f};
}

static float moment(int step)
{
	return ((float)step + 0.5f) / (STEPS / 2) - 1.0f;
}

static void test_held_picture_is_smeared_by_its_motion(void)
{
	/* Hold-type blur is a box of the width of the motion (Section 3): 8 pixels, each an eighth of the light. */
	set_motion(8.0f);
	set_column(32);
	memset(seen, 0, sizeof(seen));
	for (int step = 0; step < STEPS; step++)
		camera_expose(&path, &(struct camera_exposure){light, moment(step), 1.0f / STEPS, 0}, seen);
	float sum = 0.0f;
	for (uint32_t x = 0; x < W; x++)
		sum += seen[5 * W + x][1];
	CHECK_NEAR(sum, 1.0, 1e-5);
	for (uint32_t x = 29; x <= 35; x++)
		CHECK_NEAR(seen[5 * W + x][1], 0.125, 1e-5);
	CHECK_NEAR(seen[5 * W + 28][1], 0.0625, 1e-5);
	CHECK_NEAR(seen[5 * W + 36][1], 0.0625, 1e-5);
	CHECK_NEAR(seen[5 * W + 26][1], 0.0, 1e-6);
}

static void test_picture_that_moves_with_the_eye_is_sharp(void)
{
	set_motion(16.0f);
	memset(seen, 0, sizeof(seen));
	for (int step = 0; step < 16; step++) {
		set_column((uint32_t)(32 - 8 + step));
		camera_expose(&path, &(struct camera_exposure){light, (float)step / 8.0f - 1.0f, 1.0f / 16.0f, 0}, seen);
	}
	CHECK_NEAR(seen[5 * W + 32][1], 1.0, 1e-5);
	CHECK_NEAR(seen[5 * W + 31][1], 0.0, 1e-5);
	CHECK_NEAR(seen[5 * W + 33][1], 0.0, 1e-5);
}

static void test_path_is_a_parabola(void)
{
	/* Falling: y = s^2, so before and after are both 1 down; a sample at s = 1/2 lies 1/4 down. */
	memset(before, 0, sizeof(before));
	memset(after, 0, sizeof(after));
	for (uint32_t i = 0; i < W * H; i++)
		before[2 * i + 1] = after[2 * i + 1] = 4.0f;
	memset(light, 0, sizeof(light));
	for (uint32_t y = 0; y < H; y++)
		for (uint32_t x = 0; x < W; x++)
			light[y * W + x] = (light_pixel){(float)y, 0.0f, 0.0f, 0.0f};
	memset(seen, 0, sizeof(seen));
	camera_expose(&path, &(struct camera_exposure){light, 0.5f, 1.0f, 0}, seen);
	CHECK_NEAR(seen[3 * W + 7][0], 4.0, 1e-5);
}

static void test_rows_left_out(void)
{
	set_motion(0.0f);
	set_column(3);
	memset(seen, 0, sizeof(seen));
	camera_expose(&path, &(struct camera_exposure){light, 0.0f, 1.0f, 4}, seen);
	CHECK_NEAR(seen[4 * W + 3][0], 1.0, 0.0);
	CHECK_NEAR(seen[5 * W + 3][0], 0.0, 0.0);
}

static void test_the_edge_cannot_be_judged(void)
{
	static uint8_t valid[W * H];
	set_motion(8.0f);
	camera_path_valid(&path, valid);
	CHECK_INT(valid[2 * W + 3], 0);
	CHECK_INT(valid[2 * W + 4], 1);
	CHECK_INT(valid[2 * W + 59], 1);
	CHECK_INT(valid[2 * W + 60], 0);
}

static void test_eye_does_not_follow_everything(void)
{
	/* 10 pixels in 1/60 s are 600 pixels a second; at 0.1 degree a pixel 60 deg/s, at 0.1333 80, at 0.2 120. */
	set_motion(10.0f);
	camera_path_damp(&path, 1.0 / 60.0, 0.1);
	CHECK_NEAR(after[0], 5.0, 1e-6);
	camera_path_damp(&path, 1.0 / 60.0, 80.0 / 600.0);
	CHECK_NEAR(after[0], 2.5, 1e-4);
	CHECK_NEAR(before[0], -2.5, 1e-4);
	set_motion(10.0f);
	camera_path_damp(&path, 1.0 / 60.0, 0.2);
	CHECK_NEAR(after[0], 0.0, 0.0);
}

static void test_errors_by_speed(void)
{
	static struct canvas a, b;
	static uint8_t valid[W * H];
	struct squared_error bins[CAMERA_SPEEDS] = {{0}};
	canvas_init(&a, W, H, 10);
	canvas_init(&b, W, H, 14);
	set_motion(1.0f); /* 60 pixels a second */
	before[0] = after[0] = 0.0f;
	memset(valid, 1, sizeof(valid));
	valid[9] = 0;
	camera_errors_by_speed(&path, 1.0 / 60.0, valid, &a.picture, &b.picture, bins);
	CHECK_INT(bins[0].count, 1);
	CHECK_INT(bins[3].count + bins[4].count, W * H - 2);
	CHECK_NEAR(squared_error_root(&bins[0]), 4.0, 1e-12);
}

/* ---- energy ---- */

static light_pixel original[W * H], first[W * H], second[W * H];

static void fill(light_pixel *plane, float value)
{
	for (uint32_t i = 0; i < W * H; i++)
		plane[i] = (light_pixel){value, value, value, 0.0f};
}

static void test_boost_makes_up_for_a_darker_picture(void)
{
	struct energy_error error = {0};
	fill(original, 0.5f);
	fill(first, 0.75f);
	fill(second, 0.25f);
	const struct energy_picture pictures[2] = {{first, NULL, NULL, 0}, {second, NULL, NULL, 0}};
	energy_error_add(&error, original, pictures, 2, W, H);
	CHECK_NEAR(energy_error_root(&error), 0.0, 1e-7);
	CHECK_INT(error.count, 3 * (W / 8) * (H / 8));
	/* Without the boost a quarter of the light is lost. */
	fill(first, 0.5f);
	error = (struct energy_error){0};
	energy_error_add(&error, original, pictures, 2, W, H);
	CHECK_NEAR(energy_error_root(&error), 0.25, 1e-6);
	CHECK_NEAR(energy_error_bias(&error), -0.25, 1e-6);
}

static void test_energy_follows_motion_and_leaves_hidden_blocks_out(void)
{
	static float motion[2 * W * H];
	static uint8_t hidden[W * H];
	struct energy_error error = {0};
	for (uint32_t i = 0; i < W * H; i++) {
		original[i] = first[i] = (light_pixel){(float)(i % W), 1.0f, 1.0f, 0.0f};
		second[i] = (light_pixel){(float)(i % W) - 3.0f, 1.0f, 1.0f, 0.0f};
		motion[2 * i] = 3.0f;
		hidden[i] = i % W >= W - 8 ? REGION_HIDDEN : 0;
	}
	const struct energy_picture pictures[2] = {{first, NULL, NULL, 0}, {second, motion, hidden, REGION_HIDDEN}};
	energy_error_add(&error, original, pictures, 2, W, H);
	CHECK_NEAR(energy_error_root(&error), 0.0, 1e-7);
	CHECK_INT(error.count, 3 * (W / 8 - 1) * (H / 8));
	struct energy_error nothing = {0};
	CHECK(isnan(energy_error_root(&nothing)) && isnan(energy_error_bias(&nothing)));
}

int main(void)
{
	RUN(test_held_picture_is_smeared_by_its_motion);
	RUN(test_picture_that_moves_with_the_eye_is_sharp);
	RUN(test_path_is_a_parabola);
	RUN(test_rows_left_out);
	RUN(test_the_edge_cannot_be_judged);
	RUN(test_eye_does_not_follow_everything);
	RUN(test_errors_by_speed);
	RUN(test_boost_makes_up_for_a_darker_picture);
	RUN(test_energy_follows_motion_and_leaves_hidden_blocks_out);
	return test_result();
}
