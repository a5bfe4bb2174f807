/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Numbers that are none, and the largest and smallest that there are, in each plane: in one pixel, in a tile,
 * everywhere. The damage stays near them and is gone with the next frame.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "suite.h"

#define WIDTH 160u
#define HEIGHT 96u
/* What moves by this much at most may carry damage that far; vertices of cells beside it, their triangles and L too. */
#define MOTION 6.0
#define REACH 24u

struct area {
	uint32_t left, top, right, bottom;
	const char *name;
};

static const struct area areas[] = {
	{80, 48, 81, 49, "one pixel"}, {64, 40, 80, 56, "a tile"}, {0, 0, WIDTH, HEIGHT, "all"}};

static void swing(void *context, double x, double y, double m[2])
{
	m[0] = MOTION * sin(0.04 * x + 0.03 * y);
	m[1] = 0.5 * MOTION * cos(0.05 * y);
}

static void damage(const struct input *input, uint32_t role, const struct area *area, const void *value, size_t bytes)
{
	const struct pursuit_plane *plane;
	uint8_t *data = suite_plane(input, role, &plane);
	const uint32_t size = pursuit_format_bytes(plane->format);
	for (uint32_t j = area->top; j < area->bottom; j++)
		for (uint32_t i = area->left; i < area->right; i++)
			for (size_t at = 0; at + bytes <= size; at += bytes)
				memcpy(data + j * plane->stride + (size_t)i * size + at, value, bytes);
}

/* How far beyond the area the furthest pixel lies that differs. */
static double furthest(const uint8_t *a, const uint8_t *b, const struct area *area)
{
	double far = 0.0;
	for (uint32_t j = 0; j < HEIGHT; j++)
		for (uint32_t i = 0; i < WIDTH; i++) {
			if (memcmp(a + 4 * (j * WIDTH + i), b + 4 * (j * WIDTH + i), 4) == 0)
				continue;
			const double dx = fmax(fmax((double)area->left - i, (double)i + 1.0 - area->right), 0.0);
			const double dy = fmax(fmax((double)area->top - j, (double)j + 1.0 - area->bottom), 0.0);
			far = fmax(far, fmax(dx, dy));
		}
	return far;
}

struct whole {
	struct input good, bad;
	const char *method, *what;
	const struct area *area;
};

static void check_method(struct suite *suite, const struct whole *whole)
{
	uint32_t width, height;
	char where[TABLE_TEXT];
	/* One that looks back shows what was there for one frame longer. */
	const int memory = strcmp(whole->method, "interpolate") == 0 ? 2 : 1;
	snprintf(where, sizeof(where), "%s, %s, %s", whole->method, whole->what, whole->area->name);
	suite_method(suite, whole->method, WIDTH);
	uint8_t *wanted = suite_render(suite, &whole->good.frame, ENGINE_SHOW_IN_BETWEEN, 0.5, &width, &height);
	free(wanted);
	wanted = suite_render(suite, &whole->good.frame, ENGINE_SHOW_IN_BETWEEN, 0.5, &width, &height);
	uint8_t *damaged = suite_render(suite, &whole->bad.frame, ENGINE_SHOW_IN_BETWEEN, 0.5, &width, &height);
	uint8_t *after = NULL;
	for (int frame = 0; frame < memory; frame++) {
		free(after);
		after = suite_render(suite, &whole->good.frame, ENGINE_SHOW_IN_BETWEEN, 0.5, &width, &height);
	}
	const bool failed = !wanted || !damaged || !after;
	const double far = failed ? HUGE_VAL : furthest(wanted, damaged, whole->area);
	table_add(&suite->table, "numbers: pixels from the damage to what it changes", far, where, REACH);
	const double left = failed ? HUGE_VAL : (double)(memcmp(wanted, after, 4 * (size_t)width * height) != 0);
	table_add(&suite->table, "numbers: frames after the damage that show it", left, where, 0.0);
	free(wanted);
	free(damaged);
	free(after);
}

static void check_plane(struct suite *suite, const struct input_spec *spec, uint32_t role, const void *value,
						size_t bytes, const char *what)
{
	for (size_t a = 0; a < sizeof(areas) / sizeof(areas[0]); a++) {
		struct whole whole = {.what = what, .area = &areas[a]};
		input_make(&whole.good, spec);
		input_make(&whole.bad, spec);
		if (spec->motion_format != PURSUIT_FORMAT_RG16F) {
			suite_move(&whole.good, swing, NULL);
			suite_move(&whole.bad, swing, NULL);
		}
		damage(&whole.bad, role, &areas[a], value, bytes);
		for (const struct engine_method_info *method = engine_methods(); method->name; method++) {
			whole.method = method->name;
			check_method(suite, &whole);
		}
		suite_all_methods(suite, "numbers: undefined pixels", &whole.bad.frame);
		input_finish(&whole.good);
		input_finish(&whole.bad);
	}
}

static void check_floats(struct suite *suite)
{
	static const struct {
		const char *name;
		uint32_t bits;
	} values[] = {{"NaN", 0x7fc00000u},       {"negative NaN", 0xffc00001u}, {"infinity", 0x7f800000u},
				  {"-infinity", 0xff800000u}, {"denormal", 0x00000001u},     {"largest", 0x7f7fffffu},
				  {"-largest", 0xff7fffffu}};
	const struct input_spec spec = {.width = WIDTH, .height = HEIGHT, .image = INPUT_EDGES, .seed = 21};
	char what[64];
	for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
		snprintf(what, sizeof(what), "motion %s", values[i].name);
		check_plane(suite, &spec, PURSUIT_ROLE_MOTION, &values[i].bits, 4, what);
		snprintf(what, sizeof(what), "depth %s", values[i].name);
		check_plane(suite, &spec, PURSUIT_ROLE_DEPTH, &values[i].bits, 4, what);
	}
}

static void check_halves(struct suite *suite)
{
	static const struct {
		const char *name;
		uint16_t bits;
	} values[] = {{"half NaN", 0x7e00}, {"half infinity", 0x7c00}, {"half -infinity", 0xfc00},
				  {"half denormal", 1}, {"largest half", 0x7bff},  {"-largest half", 0xfbff}};
	const struct input_spec still = {
		.width = WIDTH, .height = HEIGHT, .field = INPUT_TRANSLATE, .seed = 22, .motion_format = PURSUIT_FORMAT_RG16F};
	struct input_spec color = still;
	char what[64];
	/* Sprinkled with such numbers as it is: the rest must not care. */
	color.color_format = PURSUIT_FORMAT_RGBA16F;
	for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
		snprintf(what, sizeof(what), "motion %s", values[i].name);
		check_plane(suite, &still, PURSUIT_ROLE_MOTION, &values[i].bits, 2, what);
		snprintf(what, sizeof(what), "colour %s", values[i].name);
		check_plane(suite, &color, PURSUIT_ROLE_COLOR, &values[i].bits, 2, what);
	}
}

void numbers_run(struct suite *suite)
{
	check_floats(suite);
	check_halves(suite);
}
