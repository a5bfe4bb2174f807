/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What must hold in every kind of context: made and given back over and over, pictures that pass through to the bit,
 * formats, sizes, several engines at once. The argument is the kind: surfaceless, gles, device, osmesa, cpu.
 */
#include "tests/test.h"

#include <errno.h>

#include "daemon/engine/engine.h"
#include "tests/engine/picture.h"

static struct engine_params params;

static struct engine *make(void)
{
	struct error error;
	struct engine *engine = engine_create(&params, &error);
	if (!engine)
		fprintf(stderr, "%s\n", error.text);
	CHECK(engine != NULL);
	return engine;
}

/* The displayed frame; the caller frees it. */
static uint8_t *render(struct engine *engine, const struct picture *picture, uint32_t n, enum engine_show show,
					   double phase)
{
	struct error error = {""};
	struct engine_begin_params begin = {.n = n, .last_phase = -1.0};
	struct engine_request request = {show, phase};
	uint8_t *pixels = calloc(picture->height, 4 * (size_t)picture->width);
	struct engine_image image = {pixels, 4 * (size_t)picture->width};
	CHECK_INT(engine_begin(engine, &picture->frame, &begin, &error), 0);
	CHECK_INT(engine_render(engine, &request, &image, &error), 0);
	if (error.text[0])
		fprintf(stderr, "%s\n", error.text);
	return pixels;
}

/* Pixels that differ from the picture's own, made opaque. */
static long count_changed(const struct picture *picture, const uint8_t *pixels)
{
	long changed = 0;
	for (uint32_t y = 0; y < picture->height; y++) {
		const uint8_t *row = picture_row(picture, PURSUIT_ROLE_COLOR, y);
		for (uint32_t x = 0; x < picture->width; x++, row += 4, pixels += 4)
			changed += memcmp(row, pixels, 3) != 0 || pixels[3] != 255;
	}
	return changed;
}

static void test_life(void)
{
	for (int i = 0; i < 6; i++) {
		struct engine *engine = make();
		CHECK(engine_get_info(engine)->renderer[0] != '\0');
		uint32_t width = 1, height = 1;
		engine_get_size(engine, &width, &height);
		CHECK_INT(width + height, 0);
		engine_destroy(&engine);
		CHECK(engine == NULL);
	}
	struct engine *none = NULL;
	engine_destroy(&none);
}

static void test_still_passes_through(void)
{
	struct engine *engine = make();
	struct picture picture;
	picture_init(&picture, 321, 123, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_fill_random(&picture, PURSUIT_ROLE_COLOR, 5);
	for (int show = ENGINE_SHOW_REAL; show <= ENGINE_SHOW_PLAIN; show++) {
		uint8_t *pixels = render(engine, &picture, 3, (enum engine_show)show, 0.5);
		CHECK_INT(count_changed(&picture, pixels), 0);
		free(pixels);
	}
	const struct engine_report *report = engine_get_report(engine);
	CHECK_STRING(report->left_out[0].name, "extrapolation");
	CHECK_STRING(report->left_out[0].reason, "still");
	picture_finish(&picture);
	engine_destroy(&engine);
}

/* Far from the only thing that moves, pixels of a warped picture are those of the source to the bit. */
static void test_resting_part_passes_through(void)
{
	struct engine *engine = make();
	struct picture picture;
	picture_init(&picture, 1000, 700, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_fill_random(&picture, PURSUIT_ROLE_COLOR, 6);
	for (uint32_t y = 80; y < 120; y++)
		for (uint32_t x = 80; x < 120; x++)
			picture_set_motion(&picture, x, y, 9.0f, 5.0f);
	uint8_t *pixels = render(engine, &picture, 3, ENGINE_SHOW_IN_BETWEEN, 0.33);
	long changed = 0;
	for (uint32_t y = 0; y < picture.height; y++)
		for (uint32_t x = 0; x < picture.width; x++)
			if (x > 160 || y > 160)
				changed += memcmp(picture_row(&picture, PURSUIT_ROLE_COLOR, y) + 4 * x,
								  pixels + 4 * ((size_t)y * picture.width + x), 3) != 0;
	CHECK_INT(changed, 0);
	CHECK(count_changed(&picture, pixels) > 500);
	free(pixels);
	picture_finish(&picture);
	engine_destroy(&engine);
}

static double srgb_code(double light)
{
	return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055;
}

static uint8_t rounded(double code)
{
	return (uint8_t)floor(255.0 * fmin(fmax(code, 0.0), 1.0) + 0.5);
}

static double from_half(uint16_t half)
{
	int exponent = half >> 10 & 31;
	double value = exponent ? ldexp(1024 + (half & 1023), exponent - 25) : ldexp(half & 1023, -24);
	return half & 0x8000 ? -value : value;
}

/* What the display must get for component c (0 red) of the first bytes of a pixel, by the formulae. */
static uint8_t expected(uint32_t format, const uint8_t *pixel, int c, bool gamma)
{
	uint32_t word;
	uint16_t halves[4];
	memcpy(&word, pixel, 4);
	if (format == PURSUIT_FORMAT_RGB10A2)
		return rounded((word >> (10 * c) & 1023u) / 1023.0);
	if (format == PURSUIT_FORMAT_RGBA16F) {
		memcpy(halves, pixel, 8);
		if ((halves[c] & 0x7c00) == 0x7c00)
			return halves[c] == 0x7c00 ? 255 : 0;
		return rounded(srgb_code(fmin(fmax(from_half(halves[c]), 0.0), 1.0)));
	}
	double code = pixel[format == PURSUIT_FORMAT_RGBA8 ? c : 2 - c] / 255.0;
	return gamma ? rounded(srgb_code(pow(code, 1.8))) : rounded(code);
}

static void check_format(struct engine *engine, uint32_t format, bool gamma)
{
	struct picture picture;
	picture_init(&picture, 300, 211, format, 0);
	picture_fill_random(&picture, PURSUIT_ROLE_COLOR, format);
	if (gamma)
		picture.frame.header.planes[0].transfer = (struct pursuit_transfer){PURSUIT_CURVE_GAMMA, 1.8f, 0.0f, 1.0f};
	uint8_t *pixels = render(engine, &picture, 2, ENGINE_SHOW_REAL, 0.0);
	uint32_t bytes = pursuit_format_bytes(format);
	long wrong = 0;
	for (uint32_t y = 0; y < picture.height; y++)
		for (uint32_t x = 0; x < picture.width; x++)
			for (int c = 0; c < 3; c++) {
				uint8_t want = expected(format, picture_row(&picture, PURSUIT_ROLE_COLOR, y) + bytes * x, c, gamma);
				int got = pixels[4 * ((size_t)y * picture.width + x) + 2 - (size_t)c];
				/* 1.8f is not 1.8: one code value where the rounding is at its edge. */
				wrong += abs(got - want) > (gamma ? 1 : 0);
			}
	CHECK_INT(wrong, 0);
	free(pixels);
	picture_finish(&picture);
}

static void test_formats(void)
{
	struct engine *engine = make();
	check_format(engine, PURSUIT_FORMAT_BGRA8, false);
	check_format(engine, PURSUIT_FORMAT_RGBA8, false);
	check_format(engine, PURSUIT_FORMAT_RGB10A2, false);
	check_format(engine, PURSUIT_FORMAT_RGBA16F, false);
	check_format(engine, PURSUIT_FORMAT_BGRA8, true);
	check_format(engine, PURSUIT_FORMAT_RGBA8, true);
	engine_destroy(&engine);
}

static void test_sizes_change(void)
{
	static const uint32_t sizes[][2] = {{1, 1}, {1, 9}, {7, 5}, {640, 360}, {333, 77}, {2, 300}, {1, 1}};
	struct engine *engine = make();
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		struct picture picture;
		picture_init(&picture, sizes[i][0], sizes[i][1], PURSUIT_FORMAT_BGRA8,
					 PICTURE_MOTION | PICTURE_DEPTH | PICTURE_UI);
		picture_draw_layers(&picture, 0.0);
		uint8_t *warped = render(engine, &picture, 3, ENGINE_SHOW_IN_BETWEEN, 0.66);
		uint8_t *plain = render(engine, &picture, 3, ENGINE_SHOW_PLAIN, 0.0);
		CHECK_INT(count_changed(&picture, plain), 0);
		uint32_t width, height;
		engine_get_size(engine, &width, &height);
		CHECK_INT(width, sizes[i][0]);
		CHECK_INT(height, sizes[i][1]);
		free(warped);
		free(plain);
		picture_finish(&picture);
	}
	engine_destroy(&engine);
}

static void test_refuses(void)
{
	struct engine *engine = make();
	struct picture picture;
	struct error error = {""};
	struct engine_begin_params begin = {.n = 2};
	struct engine_image image = {NULL, 0};
	struct engine_request request = {ENGINE_SHOW_REAL, 0.0};
	CHECK_INT(engine_render(engine, &request, &image, &error), -EINVAL);
	picture_init(&picture, 8, 8, PURSUIT_FORMAT_BGRA8, 0);
	picture.frame.header.planes[0].width = 1u << 20;
	CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), -EINVAL);
	CHECK(strstr(error.text, "1048576") != NULL);
	picture.frame.header.planes[0].role = 99;
	CHECK_INT(engine_begin(engine, &picture.frame, &begin, &error), -EINVAL);
	CHECK_INT(engine_render(engine, &request, &image, &error), -EINVAL);
	picture_finish(&picture);
	struct engine_params wrong = params;
	wrong.cell = 3;
	CHECK_INT(engine_set_params(engine, &wrong, &error), -EINVAL);
	CHECK(strstr(error.text, "cell is 3") != NULL);
	wrong = params;
	wrong.method = "magic";
	CHECK(engine_create(&wrong, &error) == NULL);
	CHECK(strstr(error.text, "grid") != NULL);
	engine_destroy(&engine);
}

/* An engine of this kind and one of the default kind take turns on one thread. */
static void test_turns(void)
{
	struct error error;
	const struct engine_params other = {0};
	struct engine *engines[3] = {make(), engine_create(&other, &error), make()};
	struct picture picture;
	picture_init(&picture, 200, 150, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH);
	picture_draw_layers(&picture, 0.0);
	uint8_t *first = NULL;
	for (int i = 0; i < 12; i++) {
		CHECK(engines[i % 3] != NULL);
		uint8_t *pixels = render(engines[i % 3], &picture, 3, ENGINE_SHOW_IN_BETWEEN, 0.66);
		if (first && i % 3 == 0)
			CHECK(memcmp(first, pixels, 4 * 200 * 150) == 0);
		if (first)
			free(pixels);
		else
			first = pixels;
	}
	free(first);
	picture_finish(&picture);
	for (int i = 0; i < 3; i++)
		engine_destroy(&engines[i]);
}

int main(int argc, char **argv)
{
	const char *kind = argc > 1 ? argv[1] : "surfaceless";
	if (strcmp(kind, "osmesa") == 0)
		params.context = ENGINE_CONTEXT_OSMESA;
	else if (strcmp(kind, "cpu") == 0)
		params.context = ENGINE_CONTEXT_CPU;
	else if (strcmp(kind, "device") == 0)
		params.context = ENGINE_CONTEXT_EGL_DEVICE;
	else
		params.context = ENGINE_CONTEXT_EGL_SURFACELESS;
	params.gles = strcmp(kind, "gles") == 0;
	struct error error;
	struct engine *engine = engine_create(&params, &error);
	if (!engine)
		SKIP(error.text);
	printf("%s: %s, %s\n", engine_get_info(engine)->context, engine_get_info(engine)->renderer,
		   engine_get_info(engine)->version);
	engine_destroy(&engine);
	RUN(test_life);
	RUN(test_still_passes_through);
	RUN(test_resting_part_passes_through);
	RUN(test_formats);
	RUN(test_sizes_change);
	RUN(test_refuses);
	RUN(test_turns);
	return test_result();
}
