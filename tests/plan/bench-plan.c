/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Milliseconds of the analysis of one frame: median and least, one thread,
 * planes in memory that may change (rows are copied first), depth of 32 bits.
 * `layers` snaps a third of the vertices, `fast` is noise: all snap, all are
 * damped. Lines to compare by:
 *   plan/1024x1024/layers/rg16f/avx2 0.961 ms, least 0.902
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "daemon/engine/analysis/levels.h"
#include "fixture.h"

#define RUNS 61

static double now_ms(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec * 1e3 + (double)time.tv_nsec * 1e-6;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

struct times {
	double median, least; /* ms */
};

static struct times times_of(const struct fixture *fixture, const struct plan_kernels *kernels, struct plan *plan)
{
	/* 22 inches of a screen 1 m away: fast motion is not damped, as in most frames. */
	const struct plan_params params = {.last_phase = 2.0f / 3, .display_width_mm = 480, .viewing_distance_mm = 1000};
	double times[RUNS] = {0};
	struct error error;
	for (int i = 0; i < RUNS; i++) {
		double start = now_ms();
		if (plan_make_with(plan, &fixture->frame, &params, kernels, &error)) {
			fprintf(stderr, "%s\n", error.text);
			exit(1);
		}
		times[i] = now_ms() - start;
	}
	qsort(times, RUNS, sizeof(times[0]), by_value);
	return (struct times){times[RUNS / 2], times[0]};
}

static void measure(uint32_t width, uint32_t height, enum fixture_field field, uint32_t format)
{
	struct fixture_spec spec = {width, height, .motion_format = format, .depth_format = PURSUIT_FORMAT_DEPTH32F};
	struct fixture fixture;
	struct plan plan = {0};
	fixture_make(&fixture, &spec);
	fixture_fill(&fixture, field, 1);
	fixture.frame.volatile_memory = true;
	for (int level = 0; level < PLAN_LEVEL_COUNT; level++) {
		const struct plan_kernels *kernels = plan_level_kernels((enum plan_level)level);
		if (!kernels)
			continue;
		struct times times = times_of(&fixture, kernels, &plan);
		printf("plan/%ux%u/%s/%s/%s %.3f ms, least %.3f\n", width, height, fixture_field_name(field),
			   format == PURSUIT_FORMAT_RG16F ? "rg16f" : "rg32f", kernels->name, times.median, times.least);
		fflush(stdout);
	}
	plan_finish(&plan);
	fixture_finish(&fixture);
}

int main(void)
{
	static const uint32_t sizes[][2] = {{640, 360}, {1024, 1024}, {1920, 1080}};
	static const enum fixture_field fields[] = {FIELD_STILL, FIELD_SMOOTH, FIELD_LAYERS, FIELD_FAST};
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
		for (size_t k = 0; k < sizeof(fields) / sizeof(fields[0]); k++) {
			measure(sizes[i][0], sizes[i][1], fields[k], PURSUIT_FORMAT_RG16F);
			measure(sizes[i][0], sizes[i][1], fields[k], PURSUIT_FORMAT_RG32F);
		}
	return 0;
}
