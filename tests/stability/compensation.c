/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Equal light over N vblanks (docs/method.md, 6), in the reference and on 8-bit targets. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "suite.h"

/* Side of the square of tiles that pair all originals with all surroundings. */
#define TILES 16u
#define TILE 8u

static const double gammas[] = {0.0, 1.0, 1.5, 2.2, 3.0, 5.0}; /* 0: sRGB */
#define GAMMAS (sizeof(gammas) / sizeof(gammas[0]))

static const double edges[] = {0.0, 4.9e-324, 1e-310, DBL_MIN, 1e-30, 1e-6, 0.04045, 0.5, 1.0 - DBL_EPSILON, 1.0};
#define EDGES (sizeof(edges) / sizeof(edges[0]))
#define VALUES (EDGES + 129)

static double value(size_t i)
{
	return i < EDGES ? edges[i] : (double)(i - EDGES) / 128.0;
}

static struct reference_transfer transfer_of(double gamma)
{
	return (struct reference_transfer){gamma > 0.0 ? PURSUIT_CURVE_GAMMA : PURSUIT_CURVE_SRGB, gamma};
}

static void check_mean(struct suite *suite, const struct reference_compensation *how, double c, double l,
					   const char *where)
{
	double between, real;
	reference_compensate(how, c, l, 1.0, &between, &real);
	const double n = how->n, o = reference_to_light(&how->display, c);
	const double light =
		(reference_to_light(&how->display, real) + (n - 1.0) * reference_to_light(&how->display, between)) / n;
	table_add(&suite->table, "compensation, double: mean light over N", fabs(light - o), where, 1e-6);
	const double out = fmax(fmax(-between, between - 1.0), fmax(-real, real - 1.0));
	table_add(&suite->table, "compensation, double: code values beyond 0 to 1", fmax(out, 0.0), where, 1e-14);
}

/* Neither picture gets darker where the original gets brighter. */
static void check_monotone(struct suite *suite, const struct reference_compensation *how, double l, const char *where)
{
	double last_between = 0.0, last_real = 0.0;
	for (int i = 0; i <= 256; i++) {
		double between, real;
		reference_compensate(how, i / 256.0, l, 1.0, &between, &real);
		const double fall = fmax(last_between - between, last_real - real);
		table_add(&suite->table, "compensation, double: fall where the original rises", fmax(fall, 0.0), where, 1e-12);
		last_between = between;
		last_real = real;
	}
}

static void check_square(struct suite *suite)
{
	char where[64];
	for (size_t g = 0; g < GAMMAS; g++)
		for (uint32_t n = 1; n <= 8; n++) {
			const struct reference_compensation how = {.display = transfer_of(gammas[g]), .n = n, .k = 1.0};
			snprintf(where, sizeof(where), "gamma %g, N %u", gammas[g], n);
			for (size_t i = 0; i < VALUES; i++) {
				for (size_t j = 0; j < VALUES; j++)
					check_mean(suite, &how, value(i), value(j), where);
				check_mean(suite, &how, value(i), value(i), where);
			}
			for (size_t j = 0; j < VALUES; j += 8)
				check_monotone(suite, &how, value(j), where);
		}
}

/* Single pixels of every brightness in surroundings of every brightness. */
static void paint_pairs(const struct input *input)
{
	const struct pursuit_plane *plane;
	uint8_t *data = suite_plane(input, PURSUIT_ROLE_COLOR, &plane);
	for (uint32_t j = 0; j < plane->height; j++)
		for (uint32_t i = 0; i < plane->width; i++)
			for (uint32_t c = 0; c < 3; c++) {
				const bool middle = i % TILE == TILE / 2 && j % TILE == TILE / 2;
				const uint32_t step = middle ? j / TILE : i / TILE;
				data[j * plane->stride + 4 * i + c] = (uint8_t)(step * 17 > c * 3 ? step * 17 - c * 3 : 0);
			}
}

static void check_pictures(struct suite *suite, const struct input *input, const struct reference_transfer *display,
						   uint32_t n, const char *where)
{
	uint32_t width, height;
	const struct pursuit_plane *plane;
	const uint8_t *original = suite_plane(input, PURSUIT_ROLE_COLOR, &plane);
	uint8_t *real = suite_render(suite, NULL, ENGINE_SHOW_REAL, 0.0, &width, &height);
	uint8_t *between = suite_render(suite, NULL, ENGINE_SHOW_IN_BETWEEN, 0.5, &width, &height);
	double worst = real && between ? 0.0 : HUGE_VAL;
	for (size_t i = 0; real && between && i < 4 * (size_t)width * height; i++) {
		const size_t at = i / 4 / width * plane->stride + i % (4 * (size_t)width);
		const double e = real[i] / 255.0, b = between[i] / 255.0, share = (n - 1.0) / n;
		if (i % 4 == 3)
			continue;
		const double light = reference_to_light(display, e) / n + share * reference_to_light(display, b);
		const double allowed = reference_half_step(display, e) / n + share * reference_half_step(display, b);
		const double off = fabs(light - reference_to_light(display, original[at] / 255.0));
		worst = fmax(worst, off / allowed);
	}
	table_add(&suite->table, "compensation, 8 bits: mean light over N, in half steps", worst, where, 1.25);
	free(real);
	free(between);
}

static void check_gamma(struct suite *suite, double gamma)
{
	const struct reference_transfer display = transfer_of(gamma);
	/* Colour comes as the display takes it, so that nothing is rounded before. */
	const struct input_spec spec = {.width = TILES * TILE,
									.height = TILES * TILE,
									.real_interval_ns = 25000000,
									.transfer = {.curve = display.curve, .gamma = (float)gamma}};
	const struct engine_params params = {
		.method = "blur-hold", .curve = gamma > 0.0 ? ENGINE_CURVE_GAMMA : ENGINE_CURVE_SRGB, .gamma = (float)gamma};
	struct input input;
	char where[TABLE_TEXT];
	input_make(&input, &spec);
	paint_pairs(&input);
	for (uint32_t n = 1; n <= 8; n++) {
		const struct engine_begin_params begin = {.n = n, .last_phase = -1.0};
		struct error error = {""};
		snprintf(where, sizeof(where), "gamma %g, N %u", gamma, n);
		if (engine_set_params(suite->engine, &params, &error) < 0 ||
			engine_begin(suite->engine, &input.frame, &begin, &error) < 0)
			table_add(&suite->table, "compensation, 8 bits: mean light over N, in half steps", HUGE_VAL, error.text,
					  1.25);
		else
			check_pictures(suite, &input, &display, n, where);
	}
	input_finish(&input);
}

void compensation_run(struct suite *suite)
{
	check_square(suite);
	for (size_t g = 0; g < GAMMAS; g++)
		check_gamma(suite, gammas[g]);
}
