/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Transfers, half floats and colour formats of the reference (docs/method.md, 0). */
#include "input.h"
#include "reference.h"
#include "tests/test.h"

static const struct reference_transfer srgb = {PURSUIT_CURVE_SRGB, 0.0};

static void test_curves(void)
{
	CHECK_NEAR(reference_to_light(&srgb, 0.5), 0.21404114, 1e-8);
	CHECK_NEAR(reference_to_light(&srgb, 0.04), 0.04 / 12.92, 1e-15);
	CHECK_NEAR(reference_from_light(&srgb, 1.0), 1.0, 1e-12);
	for (int g = 10; g <= 50; g++) {
		const struct reference_transfer power = {PURSUIT_CURVE_GAMMA, g / 10.0};
		CHECK_NEAR(reference_to_light(&power, 0.5), pow(0.5, g / 10.0), 1e-15);
		for (int c = 0; c <= 255; c++)
			CHECK_INT(reference_code8(reference_from_light(&power, reference_to_light(&power, c / 255.0)), 0.0), c);
	}
	for (int c = 0; c <= 255; c++)
		CHECK_INT(reference_code8(reference_from_light(&srgb, reference_to_light(&srgb, c / 255.0)), 0.0), c);
}

static void test_code8(void)
{
	CHECK_INT(reference_code8(0.5 / 255.0, 0.0), 1);
	CHECK_INT(reference_code8(0.4999 / 255.0, 0.0), 0);
	CHECK_INT(reference_code8(-3.0, 0.0), 0);
	CHECK_INT(reference_code8(7.0, 0.0), 255);
	CHECK_INT(reference_code8((double)NAN, 0.0), 0);
	CHECK_INT(reference_code8(0.5 / 255.0, -0.01), 0);
}

static void test_half(void)
{
	CHECK_NEAR(reference_half(0x3c00), 1.0, 0.0);
	CHECK_NEAR(reference_half(0xc500), -5.0, 0.0);
	CHECK_NEAR(reference_half(0x7bff), 65504.0, 0.0);
	CHECK_NEAR(reference_half(0x0001), ldexp(1.0, -24), 0.0);
	CHECK_NEAR(reference_half(0x03ff), 1023.0 * ldexp(1.0, -24), 0.0);
	CHECK(isinf(reference_half(0x7c00)) && isnan(reference_half(0x7e01)));
	for (uint32_t h = 0; h < 0x7c00; h++) {
		CHECK_INT(input_half(reference_half((uint16_t)h)), h);
		CHECK_INT(input_half(reference_half((uint16_t)(h | 0x8000))), h | 0x8000);
	}
}

/* One pixel of a format, converted; B G R. */
static void convert(uint32_t format, struct pursuit_transfer transfer, const void *pixel, int b, int g, int r)
{
	const struct pursuit_plane plane = {
		.role = PURSUIT_ROLE_COLOR, .format = format, .width = 1, .height = 1, .stride = 64, .transfer = transfer};
	struct reference_picture picture = {0};
	reference_convert_color(&picture, &plane, pixel, &srgb);
	CHECK_INT(picture.data[0], b);
	CHECK_INT(picture.data[1], g);
	CHECK_INT(picture.data[2], r);
	CHECK_INT(picture.data[3], 255);
	reference_picture_finish(&picture);
}

static void test_formats(void)
{
	const struct pursuit_transfer same = {.curve = PURSUIT_CURVE_SRGB}, linear = {.curve = PURSUIT_CURVE_LINEAR};
	const struct pursuit_transfer range = {.curve = PURSUIT_CURVE_LINEAR, .black = 0.5f, .peak = 4.5f};
	const struct pursuit_transfer power = {.curve = PURSUIT_CURVE_GAMMA, .gamma = 1.0f};
	const uint8_t bytes[4] = {10, 20, 30, 40};
	const uint32_t ten = 1023u | 512u << 10 | 0u << 20 | 3u << 30;
	const uint16_t halves[4] = {0x3800, 0x7e00, 0x4400, 0}; /* 0.5, NaN, 4 */
	const uint16_t odd[4] = {0x4100, 0xfc00, 0x7c00, 0};    /* 2.5, -Inf, Inf */
	convert(PURSUIT_FORMAT_BGRA8, same, bytes, 10, 20, 30);
	convert(PURSUIT_FORMAT_RGBA8, same, bytes, 30, 20, 10);
	convert(PURSUIT_FORMAT_RGB10A2, same, &ten, 0, 128, 255);
	convert(PURSUIT_FORMAT_RGBA16F, linear, halves, 255, 0, 188); /* sRGB of 0.5 is 187.5 */
	convert(PURSUIT_FORMAT_RGBA16F, range, odd, 255, 0, 188);
	convert(PURSUIT_FORMAT_BGRA8, power, bytes, 56, 79, 96); /* light 10/255 -> 56.2, 20 -> 79.3, 30 -> 95.7 */
}

int main(void)
{
	RUN(test_curves);
	RUN(test_code8);
	RUN(test_half);
	RUN(test_formats);
	return test_result();
}
