/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Milliseconds a real frame costs, everything in the picture moving: lines "engine/SIZE/nN/WHAT 12.34 ms".
 * Passes come from a run that waits after each, "total" and "cpu" (the time of all threads together, which a busy
 * machine disturbs less) from one that does not. Medians.
 *
 *   bench-engine [CONTEXT [METHOD [SIZE]]]    CONTEXT: auto, surfaceless, osmesa, cpu
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "daemon/engine/engine.h"
#include "tests/engine/picture.h"

#define FRAMES 16
#define WARM_UP 3
#define PICTURES 4

struct bench {
	struct engine *engine;
	struct picture pictures[PICTURES];
	uint8_t *out;
	uint32_t width, height, n;
	double ms[ENGINE_MAX_PASSES][FRAMES];
	double total[FRAMES], cpu[FRAMES];
};

static double now_ms(clockid_t clock)
{
	struct timespec now;
	clock_gettime(clock, &now);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double median(double *values)
{
	qsort(values, FRAMES, sizeof(*values), compare);
	return values[FRAMES / 2];
}

static void fail(const struct error *error)
{
	fprintf(stderr, "bench-engine: %s\n", error->text);
	exit(1);
}

static void run_frame(struct bench *bench, int index)
{
	struct error error;
	struct engine_image image = {bench->out, 4 * (size_t)bench->width};
	struct engine_begin_params begin = {.n = bench->n, .last_phase = -1.0};
	if (engine_begin(bench->engine, &bench->pictures[index % PICTURES].frame, &begin, &error) < 0)
		fail(&error);
	for (uint32_t i = 0; i < bench->n; i++) {
		struct engine_request request = {i ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL, (double)i / bench->n};
		if (engine_render(bench->engine, &request, &image, &error) < 0)
			fail(&error);
	}
}

static void run(struct bench *bench, bool finish)
{
	for (int i = 0; i < WARM_UP + FRAMES; i++) {
		double began = now_ms(CLOCK_MONOTONIC), cpu_began = now_ms(CLOCK_PROCESS_CPUTIME_ID);
		run_frame(bench, i);
		double total = now_ms(CLOCK_MONOTONIC) - began, cpu = now_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_began;
		if (i < WARM_UP)
			continue;
		const struct engine_report *report = engine_get_report(bench->engine);
		for (uint32_t k = 0; finish && k < report->pass_count; k++)
			bench->ms[k][i - WARM_UP] = report->passes[k].ms;
		bench->total[i - WARM_UP] = total;
		bench->cpu[i - WARM_UP] = cpu;
	}
}

static struct engine *make(const struct engine_params *params, bool finish)
{
	struct error error;
	struct engine_params own = *params;
	own.finish_each_pass = finish;
	struct engine *engine = engine_create(&own, &error);
	if (!engine)
		fail(&error);
	return engine;
}

static void print(struct bench *bench, const struct engine_report *report)
{
	for (uint32_t k = 0; k < report->pass_count; k++)
		printf("engine/%ux%u/n%u/%s %.2f ms\n", bench->width, bench->height, bench->n, report->passes[k].name,
			   median(bench->ms[k]));
}

static void bench_size(const struct engine_params *params, uint32_t width, uint32_t height)
{
	static struct bench bench;
	bench.width = width;
	bench.height = height;
	bench.out = malloc(4 * (size_t)width * height);
	for (int i = 0; i < PICTURES; i++) {
		picture_init(&bench.pictures[i], width, height, PURSUIT_FORMAT_BGRA8, PICTURE_DEPTH | PICTURE_MOTION);
		picture_draw_layers(&bench.pictures[i], i);
	}
	for (bench.n = 2; bench.n <= 3; bench.n++) {
		bench.engine = make(params, true);
		run(&bench, true);
		print(&bench, engine_get_report(bench.engine));
		engine_destroy(&bench.engine);
		bench.engine = make(params, false);
		run(&bench, false);
		const struct engine_report *report = engine_get_report(bench.engine);
		printf("engine/%ux%u/n%u/total %.2f ms\n", width, height, bench.n, median(bench.total));
		printf("engine/%ux%u/n%u/cpu %.2f ms\n", width, height, bench.n, median(bench.cpu));
		printf("# %s, %u triangles, %u doubtful, %u folded\n", engine_get_info(bench.engine)->renderer,
			   report->triangles, report->doubtful, report->folded);
		fflush(stdout);
		engine_destroy(&bench.engine);
	}
	for (int i = 0; i < PICTURES; i++)
		picture_finish(&bench.pictures[i]);
	free(bench.out);
}

int main(int argc, char **argv)
{
	static const uint32_t sizes[][2] = {{640, 360}, {1024, 1024}, {1920, 1080}};
	struct engine_params params = {.method = argc > 2 ? argv[2] : NULL};
	if (argc > 1 && strcmp(argv[1], "surfaceless") == 0)
		params.context = ENGINE_CONTEXT_EGL_SURFACELESS;
	else if (argc > 1 && strcmp(argv[1], "cpu") == 0)
		params.context = ENGINE_CONTEXT_CPU;
	else if (argc > 1 && strcmp(argv[1], "osmesa") == 0)
		params.context = ENGINE_CONTEXT_OSMESA;
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		char name[32];
		snprintf(name, sizeof(name), "%ux%u", sizes[i][0], sizes[i][1]);
		if (argc <= 3 || strcmp(argv[3], name) == 0)
			bench_size(&params, sizes[i][0], sizes[i][1]);
	}
	return 0;
}
