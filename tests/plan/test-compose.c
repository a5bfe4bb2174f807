/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Composition of motion over several frames. */
#include <errno.h>

#include "daemon/engine/analysis/compose.h"
#include "fixture.h"
#include "tests/test.h"

#define W 40u
#define H 24u

static float out[2 * W * H];

static void make(struct fixture *fixture, uint32_t format, uint32_t kind, uint32_t width, uint32_t height)
{
	struct fixture_spec spec = {W, H, .motion_format = format, .motion_width = width, .motion_height = height};
	fixture_make(fixture, &spec);
	fixture->frame.header.motion_kind = kind;
}

static void fill(struct fixture *fixture, double x, double y)
{
	for (uint32_t j = 0; j < fixture->motion_plane->height; j++)
		for (uint32_t i = 0; i < fixture->motion_plane->width; i++)
			fixture_set_motion(fixture, i, j, x, y);
}

static int compose(struct fixture *fixtures, uint32_t count)
{
	const struct frame *frames[8];
	struct error error;
	for (uint32_t k = 0; k < count; k++)
		frames[k] = &fixtures[k].frame;
	int result = motion_compose(frames, count, out, &error);
	CHECK(result == 0 || strlen(error.text) > 10);
	return result;
}

static void finish(struct fixture *fixtures, uint32_t count)
{
	for (uint32_t k = 0; k < count; k++)
		fixture_finish(&fixtures[k]);
}

static void test_constant_motion_adds_up(void)
{
	struct fixture f[3];
	for (uint32_t format = PURSUIT_FORMAT_RG16F; format <= PURSUIT_FORMAT_RG32F; format++) {
		for (uint32_t k = 0; k < 3; k++) {
			make(&f[k], format, PURSUIT_MOTION_BACKWARD, 0, 0);
			fill(&f[k], 1.5 + k, -0.25);
		}
		for (uint32_t count = 1; count <= 3; count++) {
			CHECK_INT(compose(f, count), 0);
			for (uint32_t i = 0; i < W * H; i++) {
				CHECK(out[2 * i] == (float)(count == 1 ? 1.5 : count == 2 ? 4 : 7.5));
				CHECK(out[2 * i + 1] == -0.25f * (float)count);
			}
		}
		finish(f, 3);
	}
}

/* m1 is a ramp, so that a lookup at the wrong place shows. */
static void check_direction(uint32_t kind, double way)
{
	struct fixture f[2];
	for (int k = 0; k < 2; k++)
		make(&f[k], PURSUIT_FORMAT_RG32F, kind, 0, 0);
	fill(&f[0], 3.25, 2);
	for (uint32_t j = 0; j < H; j++)
		for (uint32_t i = 0; i < W; i++)
			fixture_set_motion(&f[1], i, j, 0.125 * (i + 0.5), 0.25 * (j + 0.5));
	CHECK_INT(compose(f, 2), 0);
	for (uint32_t j = 0; j < H; j++)
		for (uint32_t i = 0; i < W; i++) {
			double x = fmin(fmax(i + 0.5 + way * 3.25, 0.5), W - 0.5), y = fmin(fmax(j + 0.5 + way * 2, 0.5), H - 0.5);
			CHECK_NEAR(out[2 * (j * W + i)], 3.25 + 0.125 * x, 1e-5);
			CHECK_NEAR(out[2 * (j * W + i) + 1], 2 + 0.25 * y, 1e-5);
		}
	finish(f, 2);
}

static void test_each_step_is_looked_up_where_the_last_leads(void)
{
	check_direction(PURSUIT_MOTION_BACKWARD, -1);
	check_direction(PURSUIT_MOTION_FORWARD, 1);
}

/* A rotation about the centre: K steps of one angle are one step of K angles. */
static void test_rotation(void)
{
	struct fixture f[4];
	const double angle = 0.02, cx = W / 2.0, cy = H / 2.0;
	for (int k = 0; k < 4; k++) {
		make(&f[k], PURSUIT_FORMAT_RG32F, PURSUIT_MOTION_BACKWARD, 0, 0);
		for (uint32_t j = 0; j < H; j++)
			for (uint32_t i = 0; i < W; i++) {
				double x = i + 0.5 - cx, y = j + 0.5 - cy;
				fixture_set_motion(&f[k], i, j, x - (x * cos(angle) + y * sin(angle)),
								   y - (y * cos(angle) - x * sin(angle)));
			}
	}
	CHECK_INT(compose(f, 4), 0);
	for (uint32_t j = 4; j < H - 4; j++)
		for (uint32_t i = 4; i < W - 4; i++) {
			double x = i + 0.5 - cx, y = j + 0.5 - cy, c = cos(4 * angle), s = sin(4 * angle);
			CHECK_NEAR(out[2 * (j * W + i)], x - (x * c + y * s), 1e-4);
			CHECK_NEAR(out[2 * (j * W + i) + 1], y - (y * c - x * s), 1e-4);
		}
	finish(f, 4);
}

static void test_silhouettes_do_not_mix(void)
{
	struct fixture f[2];
	for (int k = 0; k < 2; k++) {
		make(&f[k], PURSUIT_FORMAT_RG16F, PURSUIT_MOTION_BACKWARD, 0, 0);
		for (uint32_t j = 0; j < H; j++)
			for (uint32_t i = 0; i < W; i++)
				fixture_set_motion(&f[k], i, j, i < 20 ? 0.375 : 8, 0);
	}
	CHECK_INT(compose(f, 2), 0);
	for (uint32_t i = 0; i < W * H; i++) {
		float x = out[2 * i];
		CHECK(x == 0.75f || x == 8.375f || x == 16);
	}
	finish(f, 2);
}

static void test_geometry_of_another_size(void)
{
	struct fixture f[3];
	make(&f[0], PURSUIT_FORMAT_RG32F, PURSUIT_MOTION_BACKWARD, 20, 12);
	make(&f[1], PURSUIT_FORMAT_RG16F, PURSUIT_MOTION_BACKWARD, 80, 48);
	make(&f[2], PURSUIT_FORMAT_RG32F, PURSUIT_MOTION_BACKWARD, 1, 1);
	fill(&f[0], 4, 0);
	fill(&f[2], 0.5, 0.5);
	for (uint32_t j = 0; j < 48; j++)
		for (uint32_t i = 0; i < 80; i++)
			fixture_set_motion(&f[1], i, j, (i + 0.5) / 16, 0);
	CHECK_INT(compose(f, 3), 0);
	for (uint32_t j = 0; j < 12; j++)
		for (uint32_t i = 3; i < 20; i++) {
			double x = (i + 0.5) * 2 - 4;
			CHECK_NEAR(out[2 * (j * 20 + i)], 4 + x / 8 + 0.5, 1e-3);
			CHECK_NEAR(out[2 * (j * 20 + i) + 1], 0.5, 1e-6);
		}
	finish(f, 3);
}

static void test_what_is_no_number(void)
{
	struct fixture f[3];
	for (uint32_t k = 0; k < 3; k++) {
		make(&f[k], PURSUIT_FORMAT_RG32F, PURSUIT_MOTION_FORWARD, 0, 0);
		fill(&f[k], 1, 2);
	}
	fixture_set_motion_bits(&f[0], 5, 5, 0x7fc00000, 0);
	fixture_set_motion_bits(&f[1], 11, 12, 0, 0xff800000);
	fixture_set_motion(&f[0], 30, 3, 1e30, -1e38);
	CHECK_INT(compose(f, 3), 0);
	CHECK(isnan(out[2 * (5 * W + 5)]) && isnan(out[2 * (5 * W + 5) + 1]));
	/* The step into the hole repeats the one before it. */
	CHECK(out[2 * (10 * W + 10)] == 3 && out[2 * (10 * W + 10) + 1] == 6);
	CHECK(out[2 * (3 * W + 30)] == 65506 && out[2 * (3 * W + 30) + 1] == -65500);
	for (uint32_t i = 0; i < W * H; i++)
		CHECK(i == 5 * W + 5 || (isfinite(out[2 * i]) && isfinite(out[2 * i + 1])));
	f[1].frame.header.flags = PURSUIT_FRAME_MOTION_INVALID;
	fill(&f[1], 100, 100);
	fill(&f[2], 0.5, 0.5);
	CHECK_INT(compose(f, 3), 0);
	CHECK(out[0] == 2.5f && out[1] == 4.5f);
	f[0].frame.header.flags = PURSUIT_FRAME_CUT;
	CHECK_INT(compose(f, 3), 0);
	CHECK(isnan(out[0]));
	finish(f, 3);
}

static void test_hostile_bits(void)
{
	struct fixture f[4];
	for (uint32_t seed = 1; seed < 20; seed++) {
		for (uint32_t k = 0; k < 4; k++) {
			make(&f[k], k % 2 ? PURSUIT_FORMAT_RG16F : PURSUIT_FORMAT_RG32F, PURSUIT_MOTION_FORWARD, 0, 0);
			fixture_fill(&f[k], FIELD_BITS, seed + 100 * k);
		}
		CHECK_INT(compose(f, 4), 0);
		for (uint32_t i = 0; i < 2 * W * H; i++)
			CHECK(isnan(out[i]) || fabsf(out[i]) <= 4 * 65504.0f);
		finish(f, 4);
	}
}

static void test_refusals(void)
{
	struct fixture f[2];
	struct fixture_spec bare = {W, H};
	make(&f[0], PURSUIT_FORMAT_RG32F, PURSUIT_MOTION_FORWARD, 0, 0);
	CHECK_INT(compose(f, 0), -EINVAL);
	make(&f[1], PURSUIT_FORMAT_RG32F, PURSUIT_MOTION_BACKWARD, 0, 0);
	CHECK_INT(compose(f, 2), -EINVAL);
	fixture_finish(&f[1]);
	fixture_make(&f[1], &bare);
	CHECK_INT(compose(f, 2), -EINVAL);
	fixture_finish(&f[1]);
	make(&f[1], PURSUIT_FORMAT_RG32F, PURSUIT_MOTION_FORWARD, 0, 0);
	f[1].frame.header.planes[0].width = W + 1;
	CHECK_INT(compose(f, 2), -EINVAL);
	finish(f, 2);
}

int main(void)
{
	RUN(test_constant_motion_adds_up);
	RUN(test_each_step_is_looked_up_where_the_last_leads);
	RUN(test_rotation);
	RUN(test_silhouettes_do_not_mix);
	RUN(test_geometry_of_another_size);
	RUN(test_what_is_no_number);
	RUN(test_hostile_bits);
	RUN(test_refusals);
	return test_result();
}
