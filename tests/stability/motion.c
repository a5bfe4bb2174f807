/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Stiff motion: fast, turning, changing sign, of very different speeds, and very slow for very long. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/plan.h"
#include "suite.h"

/* Backward motion of a fan that has turned by the angle since the frame before. */
static void fan(void *context, double x, double y, double m[2])
{
	const double angle = *(const double *)context, dx = x - 60.0, dy = y - 40.0;
	if (hypot(dx, dy) > 36.0)
		return;
	m[0] = dx - (dx * cos(angle) + dy * sin(angle));
	m[1] = dy - (dy * cos(angle) - dx * sin(angle));
}

static void check_fan(struct suite *suite)
{
	static const double turns[] = {1e-6, 1e-3, 0.01, 0.05, 0.125, 0.25, 0.5, 0.75, 1.0, 1.37, 2.5, 7.1};
	struct input input;
	input_make(&input, &(struct input_spec){.width = 120, .height = 80, .image = INPUT_EDGES, .seed = 4});
	for (size_t i = 0; i < sizeof(turns) / sizeof(turns[0]); i++) {
		double angle = 2.0 * acos(-1.0) * turns[i];
		char name[TABLE_TEXT];
		snprintf(name, sizeof(name), "fan, %g turns a real interval: steps off the reference", turns[i]);
		suite_move(&input, fan, &angle);
		suite_against_reference(suite, name, &input.frame, &(struct engine_params){0}, 2.0 / 3.0);
		suite_all_methods(suite, "fan, all speeds: undefined pixels", &input.frame);
	}
	input_finish(&input);
}

/* Of one thing (a box) and what is behind it. */
static void box(void *context, double x, double y, double m[2])
{
	const double *speeds = context;
	const bool inside = x > 40.0 && x < 80.0 && y > 24.0 && y < 56.0;
	m[0] = inside ? speeds[0] : speeds[1];
}

/* A frame looks the same whatever came before it, with every method that keeps nothing. */
static void check_flips(struct suite *suite)
{
	static const char *const methods[] = {"grid", "adaptive-grid", "pursuit", "scatter", "mcif", "blur-hold"};
	struct input there, back;
	const struct input_spec spec = {.width = 120, .height = 80, .image = INPUT_EDGES, .seed = 5};
	double forth[2] = {30.0, -3.0}, other[2] = {-30.0, 3.0};
	input_make(&there, &spec);
	input_make(&back, &spec);
	suite_move(&there, box, forth);
	suite_move(&back, box, other);
	suite_against_reference(suite, "motion that flips sign: steps off the reference", &back.frame,
							&(struct engine_params){0}, 2.0 / 3.0);
	for (size_t i = 0; i < sizeof(methods) / sizeof(methods[0]); i++) {
		uint32_t width, height;
		suite_method(suite, methods[i], spec.width);
		uint8_t *first = suite_render(suite, &there.frame, ENGINE_SHOW_IN_BETWEEN, 0.5, &width, &height);
		uint8_t *again = NULL;
		for (int frame = 0; frame < 8; frame++) {
			free(again);
			again = suite_render(suite, frame & 1 ? &there.frame : &back.frame, ENGINE_SHOW_IN_BETWEEN, 0.5, &width,
								 &height);
		}
		uint64_t wrong = first && again ? 0 : UINT64_MAX;
		for (size_t at = 0; first && again && at < (size_t)width * height; at++)
			wrong += memcmp(first + 4 * at, again + 4 * at, 4) != 0;
		table_add(&suite->table, "motion that flips sign 8 times: pixels changed by the past", (double)wrong,
				  methods[i], 0.0);
		free(first);
		free(again);
	}
	input_finish(&there);
	input_finish(&back);
}

static void check_speeds(struct suite *suite)
{
	static const double speeds[][2] = {{10000.0, 1.0}, {1000.0, 0.1}, {100.0, 0.01}, {40.0, 0.004}, {60.0, 0.0}};
	struct input input;
	input_make(&input, &(struct input_spec){.width = 120, .height = 80, .image = INPUT_EDGES, .seed = 6});
	for (size_t i = 0; i < sizeof(speeds) / sizeof(speeds[0]); i++) {
		double pair[2] = {speeds[i][0], speeds[i][1]};
		suite_move(&input, box, pair);
		suite_against_reference(suite, "speeds of 10000 to 1 in one frame: steps off the reference", &input.frame,
								&(struct engine_params){0}, 2.0 / 3.0);
		/* Without the limit of tracking: a display seen from afar. */
		suite_against_reference(suite, "speeds of 10000 to 1, all trackable: steps off the reference", &input.frame,
								&(struct engine_params){.viewing_distance_mm = 1e6f}, 2.0 / 3.0);
		suite_all_methods(suite, "speeds of 10000 to 1: undefined pixels", &input.frame);
	}
	input_finish(&input);
}

static void alike(void *context, double x, double y, double m[2])
{
	m[0] = *(const double *)context;
	m[1] = 0.5 * m[0];
}

/* From rest beyond the tracking limit: u rises with the motion, is damped and ends at rest, without a jump. */
static void check_acceleration(struct suite *suite)
{
	struct input input;
	struct plan plan = {0};
	struct error error = {""};
	const struct plan_params params = {.display_width_mm = 500.0f, .viewing_distance_mm = 600.0f};
	double last = 0.0, worst = 0.0, jump = 0.0;
	input_make(&input, &(struct input_spec){.width = 64, .height = 48});
	const double step = 1e-3;
	for (double speed = 0.0; speed < 4.0; speed += step) {
		suite_move(&input, alike, &speed);
		if (plan_make(&plan, &input.frame, &params, &error) < 0)
			worst = HUGE_VAL;
		const double length = hypot(speed, 0.5 * speed), seconds = (double)input.frame.header.real_interval_ns * 1e-9;
		const double factor = reference_tracking(reference_speed(length, seconds, 64.0, 500.0, 600.0));
		const double u = plan.columns ? (double)plan.vertices[(size_t)plan.columns + 1].ux : 0.0;
		worst = fmax(worst, fabs(u - factor * speed));
		jump = fmax(jump, fabs(u - last));
		last = u;
	}
	table_add(&suite->table, "acceleration to the tracking limit: pixels off the formula", worst, "u", 2e-5);
	table_add(&suite->table, "acceleration to the tracking limit: jump from frame to frame, pixels", jump, "u",
			  30.0 * step);
	plan_finish(&plan);
	input_finish(&input);
}

/* The same slow motion again and again: nothing may add up. */
static void check_drift(struct suite *suite)
{
	struct input input;
	uint32_t width, height;
	double slow = 0.013;
	const uint32_t frames = suite->complete ? 100000 : 2000;
	input_make(&input, &(struct input_spec){.width = 32, .height = 16, .image = INPUT_NOISE, .seed = 9});
	suite_move(&input, alike, &slow);
	suite_method(suite, "pursuit", 32);
	uint8_t *first = suite_render(suite, &input.frame, ENGINE_SHOW_IN_BETWEEN, 0.5, &width, &height);
	uint64_t wrong = 0;
	for (uint32_t i = 0; first && i < frames; i++) {
		uint8_t *later = suite_render(suite, &input.frame, ENGINE_SHOW_IN_BETWEEN, 0.5, &width, &height);
		wrong += !later || memcmp(first, later, 4 * (size_t)width * height) != 0;
		free(later);
	}
	char where[64];
	snprintf(where, sizeof(where), "of %u frames", frames);
	table_add(&suite->table, "sub-pixel motion for very long: frames unlike the first",
			  first ? (double)wrong : HUGE_VAL, where, 0.0);
	free(first);
	struct plan plan = {0};
	struct error error = {""};
	double worst = 0.0;
	for (uint32_t i = 0; i < 100000; i++) {
		if (plan_make(&plan, &input.frame, &(struct plan_params){0}, &error) < 0 || !plan.columns)
			worst = HUGE_VAL;
		else
			worst = fmax(worst, fabs((double)plan.vertices[plan.columns + 1].ux - slow));
	}
	table_add(&suite->table, "sub-pixel motion for 100000 frames: displacement off, pixels", worst, "plan", 1e-8);
	plan_finish(&plan);
	input_finish(&input);
}

void motion_run(struct suite *suite)
{
	check_fan(suite);
	check_flips(suite);
	check_speeds(suite);
	check_acceleration(suite);
	check_drift(suite);
}
