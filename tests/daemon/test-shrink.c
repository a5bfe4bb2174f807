/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pictures made smaller, against the definition in double precision with sRGB's own curve. */
#include "daemon/present/shrink.h"
#include "tests/test.h"

/* Code values; what the header promises. */
#define TOLERANCE 3.0
/* Bytes between rows beyond what they need, and around the target. */
#define SPARE 12u

struct picture {
	uint32_t width, height;
	size_t stride;
	uint8_t *data;
};

/* Exactly as much memory as it needs, so that a sanitizer sees what goes beyond it. */
static struct picture make_picture(uint32_t width, uint32_t height)
{
	struct picture picture = {width, height, (size_t)width * 4 + SPARE, NULL};
	picture.data = malloc(picture.stride * (height - 1) + (size_t)width * 4);
	memset(picture.data, 0x5a, picture.stride * (height - 1) + (size_t)width * 4);
	return picture;
}

static uint8_t *pixel(const struct picture *picture, uint32_t x, uint32_t y)
{
	return picture->data + y * picture->stride + (size_t)x * 4;
}

static double to_light(uint8_t code)
{
	const double v = code / 255.0;
	return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static double to_code(double light)
{
	return 255.0 * (light <= 0.0031308 ? light * 12.92 : 1.055 * pow(light, 1.0 / 2.4) - 0.055);
}

/* Of [from, from + 1) that of [to, to + 1), in pixels of the larger picture. */
static double overlap(uint32_t from, uint32_t to, double ratio)
{
	const double first = fmax(from, to * ratio), last = fmin(from + 1.0, (to + 1.0) * ratio);
	return fmax(0.0, last - first);
}

static double expected(const struct picture *from, const struct picture *to, uint32_t x, uint32_t y, int channel)
{
	const double across = (double)from->width / to->width, down = (double)from->height / to->height;
	double sum = 0.0;
	for (uint32_t v = (uint32_t)(y * down); v < from->height && v < (y + 1) * down; v++)
		for (uint32_t u = (uint32_t)(x * across); u < from->width && u < (x + 1) * across; u++)
			sum += overlap(u, x, across) * overlap(v, y, down) * to_light(pixel(from, u, v)[channel]);
	return to_code(sum / across / down);
}

static void run(const struct picture *from, const struct picture *to)
{
	struct shrink *shrink = shrink_create(from->width, from->height, to->width, to->height);
	CHECK(shrink != NULL);
	/* Twice: nothing stays behind. */
	shrink_run(shrink, from->data, from->stride, to->data, to->stride);
	shrink_run(shrink, from->data, from->stride, to->data, to->stride);
	shrink_destroy(&shrink);
	CHECK(shrink == NULL);
}

/* Many of them dark. */
static uint8_t next(uint32_t *seed)
{
	*seed = *seed * 1664525 + 1013904223;
	return (uint8_t)(*seed >> (*seed >> 12 & 1 ? 24 : 26));
}

static const uint32_t sizes[][4] = {{64, 48, 32, 24}, {90, 60, 30, 20}, {53, 31, 40, 23},
									{17, 19, 17, 19}, {33, 7, 32, 7},   {9, 200, 1, 23},
									{1, 1, 1, 1},     {301, 2, 100, 1}, {127, 64, 126, 63}};

static void test_mean_light(void)
{
	uint32_t seed = 1;
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		const struct picture from = make_picture(sizes[i][0], sizes[i][1]), to = make_picture(sizes[i][2], sizes[i][3]);
		double worst = 0.0;
		for (uint32_t y = 0; y < from.height; y++)
			for (uint32_t x = 0; x < from.width * 4; x++)
				pixel(&from, 0, y)[x] = next(&seed);
		run(&from, &to);
		for (uint32_t y = 0; y < to.height; y++)
			for (uint32_t x = 0; x < to.width; x++) {
				for (int channel = 0; channel < 3; channel++)
					worst = fmax(worst, fabs(expected(&from, &to, x, y, channel) - pixel(&to, x, y)[channel]));
				CHECK_INT(pixel(&to, x, y)[3], 255);
			}
		CHECK_NEAR(worst, 0.0, TOLERANCE);
		for (uint32_t y = 0; y + 1 < to.height; y++)
			CHECK_INT(pixel(&to, to.width, y)[0], 0x5a);
		free(from.data);
		free(to.data);
	}
}

/* Every mixture of two codes in two pixels. */
static void test_all_pairs(void)
{
	const struct picture from = make_picture(512, 256), to = make_picture(256, 256);
	double worst = 0.0;
	for (uint32_t y = 0; y < 256; y++)
		for (uint32_t x = 0; x < 512; x++)
			memset(pixel(&from, x, y), (int)(x % 2 ? y : x / 2), 4);
	run(&from, &to);
	for (uint32_t y = 0; y < 256; y++)
		for (uint32_t x = 0; x < 256; x++)
			worst = fmax(worst, fabs(expected(&from, &to, x, y, 1) - pixel(&to, x, y)[1]));
	printf("  largest difference of a mixture of two: %.2f codes\n", worst);
	CHECK_NEAR(worst, 0.0, TOLERANCE);
	free(from.data);
	free(to.data);
}

static void test_one_colour_stays(void)
{
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		const struct picture from = make_picture(sizes[i][0], sizes[i][1]), to = make_picture(sizes[i][2], sizes[i][3]);
		for (int code = 0; code < 256; code++) {
			uint32_t wrong = 0;
			for (uint32_t y = 0; y < from.height; y++)
				memset(pixel(&from, 0, y), code, (size_t)from.width * 4);
			run(&from, &to);
			for (uint32_t y = 0; y < to.height; y++)
				for (uint32_t x = 0; x < to.width; x++)
					wrong += pixel(&to, x, y)[0] != code || pixel(&to, x, y)[1] != code || pixel(&to, x, y)[2] != code;
			CHECK_INT(wrong, 0);
		}
		free(from.data);
		free(to.data);
	}
}

int main(void)
{
	RUN(test_mean_light);
	RUN(test_all_pairs);
	RUN(test_one_colour_stays);
	return test_result();
}
