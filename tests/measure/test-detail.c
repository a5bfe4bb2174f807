/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Flicker, detail, ripple and regions against cases worked out by hand. */
#include <math.h>

#include "canvas.h"
#include "daemon/measure/detail.h"
#include "daemon/measure/light.h"
#include "daemon/measure/regions.h"
#include "tests/test.h"

static struct canvas a, b, c, d;

static void test_tpsnr_ignores_a_constant_error(void)
{
	canvas_init(&a, 8, 8, 110);
	canvas_init(&b, 8, 8, 120);
	canvas_init(&c, 8, 8, 100);
	canvas_init(&d, 8, 8, 110);
	CHECK_NEAR(measure_tpsnr(&a.picture, &b.picture, &c.picture, &d.picture), 100.0, 0.0);
}

static void test_tpsnr_sees_flicker(void)
{
	/* One step of 5 more than the truth's in every channel: 20 log10(255 / 5). */
	canvas_init(&a, 8, 8, 100);
	canvas_init(&b, 8, 8, 115);
	canvas_init(&c, 8, 8, 100);
	canvas_init(&d, 8, 8, 110);
	CHECK_NEAR(measure_tpsnr(&a.picture, &b.picture, &c.picture, &d.picture), 34.15140352, 1e-6);
}

static void test_high_frequency_of_an_impulse(void)
{
	/* Impulse 16 in a wide picture: what is left is 16 (delta - k), k = (1 4 6 4 1)^2/256; its squares sum to
	 * 256 (1 - 2 x 36/256 + (70/256)^2), over 32 x 32 pixels. */
	canvas_init(&a, 32, 32, 0);
	canvas_set(&a, 16, 16, 16);
	const double sum = 256.0 * (1.0 - 72.0 / 256.0 + 70.0 / 256.0 * 70.0 / 256.0);
	CHECK_NEAR(measure_high_frequency(&a.picture), sum / 1024.0, 1e-5);
}

static void test_high_frequency_of_flat_and_stripes(void)
{
	canvas_init(&a, 9, 7, 93);
	CHECK_NEAR(measure_high_frequency(&a.picture), 0.0, 1e-6);
	/* Stripes of one pixel are exactly what the low-pass takes away: half their height is left, each way. */
	canvas_init(&b, 64, 64, 100);
	for (uint32_t x = 0; x < 64; x += 2)
		canvas_column(&b, x, 120);
	CHECK_NEAR(measure_high_frequency(&b.picture), 100.0, 4.0);
}

static void test_ripple(void)
{
	const double luminances[3] = {0.5, 0.1, 0.3}, dark[2] = {0.0, 0.0}, black[2] = {0.4, 0.0};
	CHECK_NEAR(light_ripple(luminances, 3), 0.4 / 0.6, 1e-12);
	CHECK_NEAR(light_ripple(dark, 2), 0.0, 0.0);
	CHECK_NEAR(light_ripple(black, 2), 1.0, 0.0);
	CHECK_NEAR(light_ripple(luminances, 0), 0.0, 0.0);
}

static void test_light_and_back(void)
{
	static struct light_transfer srgb, square;
	light_transfer_init(&srgb, 0.0);
	light_transfer_init(&square, 2.0);
	CHECK_NEAR(srgb.light[255], 1.0, 0.0);
	CHECK_NEAR(srgb.light[188], 0.502886, 1e-6);
	CHECK_NEAR(square.light[51], 0.04, 1e-7);
	uint8_t bgra[4];
	for (uint32_t code = 0; code < 256; code++) {
		const light_pixel light = {srgb.light[code], srgb.light[255 - code], 2.0f, 0.0f};
		light_to_codes(&srgb, &light, 1, bgra);
		CHECK_INT(bgra[0], code);
		CHECK_INT(bgra[1], 255 - code);
		CHECK_INT(bgra[2], 255);
	}
	const light_pixel wild = {NAN, -1.0f, INFINITY, 0.0f};
	light_to_codes(&srgb, &wild, 1, bgra);
	CHECK_INT(bgra[0] + bgra[1], 0);
	CHECK_INT(bgra[2], 255);
}

static void test_luminance(void)
{
	const light_pixel light[2] = {{1.0f, 0.0f, 0.0f, 0.0f}, {0.0f, 0.5f, 1.0f, 0.0f}};
	CHECK_NEAR(light_mean_luminance(light, 2), (0.0722 + 0.5 * 0.7152 + 0.2126) / 2.0, 1e-7);
}

/* A square of 4 x 4, object 1, moves right by 3 over a still background, object 0. */
#define W 16u
#define H 12u
static float here_motion[2 * W * H], there_motion[2 * W * H];
static uint32_t here_ids[W * H], there_ids[W * H];

static void place_square(uint32_t left, float motion_x, float *motion, uint32_t *ids)
{
	memset(motion, 0, sizeof(float) * 2 * W * H);
	memset(ids, 0, sizeof(uint32_t) * W * H);
	for (uint32_t y = 4; y < 8; y++)
		for (uint32_t x = left; x < left + 4; x++) {
			motion[2 * (y * W + x)] = motion_x;
			ids[y * W + x] = 1;
		}
}

static void test_regions(void)
{
	static uint8_t mask[W * H];
	place_square(5, -3.0f, here_motion, here_ids);
	place_square(2, 3.0f, there_motion, there_ids);
	for (int with_ids = 0; with_ids < 2; with_ids++) {
		const struct region_view here = {here_motion, with_ids ? here_ids : NULL, NULL};
		const struct region_view there = {there_motion, there_ids, NULL};
		regions_find(&here, &there, W, H, mask);
		uint32_t moving = 0, hidden = 0;
		for (uint32_t i = 0; i < W * H; i++) {
			moving += (mask[i] & REGION_MOVING) != 0;
			hidden += (mask[i] & REGION_HIDDEN) != 0;
		}
		CHECK_INT(moving, 16);
		/* What the square has left: three columns. A pixel centre needs its own place, whose neighbours to the
		 * right and below count with weight 0 here; the outermost ones see a neighbour that was visible. */
		CHECK(hidden >= 4 && hidden <= 12);
		CHECK(mask[5 * W + 3] & REGION_HIDDEN);
		CHECK_INT(mask[5 * W + 6], REGION_MOVING);
		CHECK_INT(mask[1 * W + 3], 0);
	}
}

static void test_regions_outside(void)
{
	static uint8_t mask[W * H];
	memset(here_motion, 0, sizeof(here_motion));
	memset(there_motion, 0, sizeof(there_motion));
	for (uint32_t i = 0; i < W * H; i++) {
		here_motion[2 * i] = -2.0f;
		there_motion[2 * i] = 2.0f;
	}
	const struct region_view here = {here_motion, NULL, NULL}, there = {there_motion, NULL, NULL};
	regions_find(&here, &there, W, H, mask);
	CHECK_INT(mask[0], REGION_MOVING | REGION_HIDDEN);
	CHECK_INT(mask[1], REGION_MOVING | REGION_HIDDEN);
	CHECK_INT(mask[2], REGION_MOVING);
}

static void test_regions_guessed(void)
{
	static uint8_t mask[W * H];
	static float near_then[W * H], now[W * H];
	memset(here_motion, 0, sizeof(here_motion));
	for (uint32_t i = 0; i < W * H; i++)
		now[i] = near_then[i] = 10.0f;
	near_then[5] = 5.0f;
	near_then[6] = 9.5f;
	here_motion[2 * 7] = NAN;
	const struct region_view here = {here_motion, NULL, now}, there = {NULL, NULL, near_then};
	regions_guess(&here, &there, W, H, mask);
	CHECK_INT(mask[4], 0);
	CHECK_INT(mask[5], REGION_HIDDEN);
	CHECK_INT(mask[6], 0);
	CHECK_INT(mask[7], REGION_HIDDEN);
}

static void test_error_of_a_region(void)
{
	uint8_t mask[16] = {0};
	struct squared_error all = {0}, some = {0}, none = {0};
	canvas_init(&a, 4, 4, 50);
	canvas_init(&b, 4, 4, 50);
	canvas_set(&b, 1, 0, 60);
	mask[1] = 3;
	mask[2] = 1;
	squared_error_add(&all, &a.picture, &b.picture, NULL, 0);
	squared_error_add(&some, &a.picture, &b.picture, mask, 1);
	squared_error_add(&none, &a.picture, &b.picture, mask, 4);
	CHECK_NEAR(squared_error_root(&all), 2.5, 1e-12);
	CHECK_NEAR(squared_error_psnr(&all), measure_psnr(&a.picture, &b.picture), 1e-9);
	CHECK_INT(some.count, 2);
	CHECK_NEAR(squared_error_root(&some), sqrt(50.0), 1e-12);
	CHECK(isnan(squared_error_psnr(&none)));
	struct squared_error equal = {0};
	squared_error_add(&equal, &a.picture, &a.picture, NULL, 0);
	CHECK_NEAR(squared_error_psnr(&equal), 100.0, 0.0);
}

int main(void)
{
	RUN(test_tpsnr_ignores_a_constant_error);
	RUN(test_tpsnr_sees_flicker);
	RUN(test_high_frequency_of_an_impulse);
	RUN(test_high_frequency_of_flat_and_stripes);
	RUN(test_ripple);
	RUN(test_light_and_back);
	RUN(test_luminance);
	RUN(test_regions);
	RUN(test_regions_outside);
	RUN(test_regions_guessed);
	RUN(test_error_of_a_region);
	return test_result();
}
