/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Conversions of the read-back that llvmpipe never asks for, and the half float against an exact search. */

#include "client/gl_api.h"
#include "client/gl_rows.h"
#include "client/gl_transfer.h"
#include "proto/frame.h"
#include "tests/test.h"

static double half_value(uint32_t half)
{
	int exponent = (int)(half >> 10 & 31);
	double mantissa = half & 0x3ff;
	return exponent ? ldexp(1024 + mantissa, exponent - 25) : ldexp(mantissa, -24);
}

/* The nearest half among all of them, ties to the even one; 65536 stands for infinity. */
static uint32_t nearest_half(double value)
{
	uint32_t low = 0, high = 0x7c00;

	while (high - low > 1) {
		uint32_t middle = (low + high) / 2;
		*(half_value(middle) <= value ? &low : &high) = middle;
	}
	double below = value - half_value(low), above = (high == 0x7c00 ? 65536.0 : half_value(high)) - value;
	return below < above || (below == above && low % 2 == 0) ? low : high;
}

static void test_half(void)
{
	uint32_t state = 1;

	for (uint32_t half = 0; half <= 0x7c00; half++) {
		double value = half == 0x7c00 ? (double)INFINITY : half_value(half);
		CHECK_INT(shim_half((float)value), half);
		CHECK_INT(shim_half((float)-value), half | 0x8000u);
	}
	for (int i = 0; i < 200000; i++) {
		float value;
		state = state * 1664525u + 1013904223u;
		uint32_t bits = state % 0x48000000u; /* up to 131072 */
		memcpy(&value, &bits, 4);
		CHECK_INT(shim_half(value), nearest_half((double)value));
	}
	CHECK_INT(shim_half(65519.996f), 0x7bff);
	CHECK_INT(shim_half(65520.0f), 0x7c00);
	CHECK_INT(shim_half(0x1p-25f), 0);
	CHECK_INT(shim_half(0x1.000002p-25f), 1);
	CHECK_INT(shim_half(NAN) & 0x7e00, 0x7e00);
}

static void test_floats(void)
{
	const float from[8] = {0.25f, -2.0f, 3.0f, 4.0f, NAN, INFINITY, 7.0f, 8.0f};
	const struct shim_row_options four = {.channels = 4, .negate_y = 1};
	uint8_t bytes[64];
	float floats[4];
	uint16_t halves[8];
	uint32_t words[2];

	shim_row_motion_float(bytes, (const uint8_t *)from, 2, &four);
	memcpy(floats, bytes, sizeof(floats));
	CHECK(floats[0] == 0.25f && floats[1] == 2.0f && isnan(floats[2]) && floats[3] == -INFINITY);
	shim_row_motion_to_half(bytes, (const uint8_t *)from, 2, &four);
	memcpy(halves, bytes, 8);
	CHECK(halves[0] == 0x3400 && halves[1] == 0x4000 && halves[3] == 0xfc00);
	shim_row_color_half(bytes, (const uint8_t *)from, 2, &four);
	memcpy(halves, bytes, 16);
	CHECK(halves[0] == 0x3400 && halves[1] == 0xc000 && halves[7] == 0x4800);
	shim_row_depth_float(bytes, (const uint8_t *)from, 2, &four);
	memcpy(floats, bytes, 8);
	CHECK(floats[0] == 0.25f && isnan(floats[1]));
	shim_row_depth16(bytes, (const uint8_t *)from, 2, &four);
	memcpy(halves, bytes, 4);
	CHECK(halves[0] == 16384 && halves[1] == 0);
	shim_row_depth24(bytes, (const uint8_t *)from, 2, &four);
	memcpy(words, bytes, 8);
	CHECK(words[0] == 4194304 && words[1] == 0);
	shim_row_depth24(bytes, (const uint8_t *)&from[1], 1, &four);
	memcpy(words, bytes, 4);
	CHECK_INT(words[0], 0);
	shim_row_depth24(bytes, (const uint8_t *)&from[2], 1, &four);
	memcpy(words, bytes, 4);
	CHECK_INT(words[0], 0xffffff);
}

static void test_integers(void)
{
	const uint32_t from[8] = {7, 1, 1, 1, 70000, 1, 1, 1};
	const struct shim_row_options four = {.channels = 4};
	uint8_t bytes[8];
	uint16_t shorts[2];
	uint32_t words[2];

	shim_row_id8(bytes, (const uint8_t *)from, 2, &four);
	CHECK(bytes[0] == 7 && bytes[1] == 255);
	shim_row_id16(bytes, (const uint8_t *)from, 2, &four);
	memcpy(shorts, bytes, 4);
	CHECK(shorts[0] == 7 && shorts[1] == 65535);
	shim_row_id32(bytes, (const uint8_t *)from, 2, &four);
	memcpy(words, bytes, 8);
	CHECK(words[0] == 7 && words[1] == 70000);
}

/* A GLES driver that offers nothing beyond what it must. */
static void test_portable_pairs(void)
{
	const struct {
		uint32_t role, format, component, red_bits, pixel_bytes;
	} cases[] = {
		{PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_BGRA8, SHIM_GL_UNSIGNED_NORMALIZED, 8, 4},
		{PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_RGBA16F, SHIM_GL_FLOAT, 16, 16},
		{PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_RGB10A2, SHIM_GL_UNSIGNED_NORMALIZED, 10, 4},
		{PURSUIT_ROLE_DEPTH, PURSUIT_FORMAT_DEPTH16, SHIM_GL_FLOAT, 32, 16},
		{PURSUIT_ROLE_DEPTH, PURSUIT_FORMAT_DEPTH24, SHIM_GL_FLOAT, 32, 16},
		{PURSUIT_ROLE_DEPTH, PURSUIT_FORMAT_DEPTH32F, SHIM_GL_FLOAT, 32, 16},
		{PURSUIT_ROLE_MOTION, PURSUIT_FORMAT_RG16F, SHIM_GL_FLOAT, 16, 16},
		{PURSUIT_ROLE_MOTION, PURSUIT_FORMAT_RG32F, SHIM_GL_FLOAT, 32, 16},
		{PURSUIT_ROLE_OBJECT_ID, PURSUIT_FORMAT_R8UI, SHIM_GL_UNSIGNED_INT, 8, 16},
		{PURSUIT_ROLE_OBJECT_ID, PURSUIT_FORMAT_R16UI, SHIM_GL_UNSIGNED_INT, 16, 16},
		{PURSUIT_ROLE_OBJECT_ID, PURSUIT_FORMAT_R32UI, SHIM_GL_UNSIGNED_INT, 32, 16},
		/* Not to be had: */
		{PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_BGRA8, SHIM_GL_FLOAT, 16, 0},
		{PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_RGB10A2, SHIM_GL_UNSIGNED_NORMALIZED, 8, 0},
		{PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_RGBA8, SHIM_GL_UNSIGNED_INT, 8, 0},
		{PURSUIT_ROLE_MOTION, PURSUIT_FORMAT_RG16F, SHIM_GL_UNSIGNED_NORMALIZED, 8, 0},
		{PURSUIT_ROLE_OBJECT_ID, PURSUIT_FORMAT_R8UI, SHIM_GL_INT, 8, 0},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct shim_gl_source source = {
			.es = true, .component_type = cases[i].component, .red_bits = cases[i].red_bits};
		struct shim_gl_transfer transfer = {0};
		const char *wrong = shim_gl_transfer_choose(&transfer, cases[i].role, cases[i].format, &source);
		CHECK_INT(wrong == NULL, cases[i].pixel_bytes != 0);
		CHECK_INT(transfer.pixel_bytes, cases[i].pixel_bytes);
	}
}

int main(void)
{
	RUN(test_half);
	RUN(test_floats);
	RUN(test_integers);
	RUN(test_portable_pairs);
	return test_result();
}
