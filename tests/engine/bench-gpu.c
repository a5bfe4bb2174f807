/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The engine on a GPU: milliseconds of each pass by timer queries, everything in the picture moving, transfers apart,
 * and the bytes per second of passes whose least traffic is known, against copies from texture to texture measured in
 * the same run. Input comes from several frames in turn. Medians.
 *
 *   bench-gpu [--allow-software] [--quick]
 *
 * Without a GPU it says so and exits with 77. --allow-software: then GL on the CPU, by the same timer queries, with
 * figures that tell nothing about a GPU and say so; --quick: small and few, to see that it works.
 *
 * analyse: motion and depth to the plan, by the CPU from its memory, and by the GPU with the way up and back.
 * frame: by the clock, from the planes to all pictures in memory: each picture waited for, and each coming back while
 * the next one is drawn or the next real frame begun.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/engine.h"
#include "tests/engine/bench-copy.h"
#include "tests/engine/bench-read.h"
#include "tests/engine/picture.h"

#define FRAMES 31u
#define WARM_UP 5u
#define PICTURES 4u
#define SKIPPED 77

static const struct goal {
	uint32_t width, height, rate, n;
	double ms; /* of all passes on a data-centre GPU; 0: none */
} goals[] = {{1024, 1024, 40, 3, 0.2}, {3840, 2160, 60, 2, 0.6}}, quick_goal = {256, 192, 60, 2, 0.0};

/* One pass over all frames. */
struct sample {
	const char *name;
	double ms[FRAMES];
	uint32_t count, runs;
};

struct bench {
	struct engine_params params;
	struct engine *engine;
	const struct goal *goal;
	struct picture pictures[PICTURES];
	uint8_t *out; /* NULL: pictures stay in the renderer's memory */
	uint32_t frames;
	struct sample samples[ENGINE_MAX_PASSES];
	uint64_t bytes_up, bytes_down; /* of the last frame */
	double copy_rate;
};

static void fail(const struct error *error)
{
	fprintf(stderr, "bench-gpu: %s\n", error->text);
	exit(1);
}

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double median(struct sample *sample)
{
	qsort(sample->ms, sample->count, sizeof(sample->ms[0]), compare);
	return sample->count ? sample->ms[sample->count / 2] : 0.0;
}

/* ---- frames ---- */

static void show(struct bench *bench, uint32_t index)
{
	const struct engine_begin_params begin = {.n = bench->goal->n, .last_phase = -1.0};
	struct engine_image image = {.data = bench->out, .stride = 4 * (size_t)bench->goal->width};
	struct error error;
	if (engine_begin(bench->engine, &bench->pictures[index % PICTURES].frame, &begin, &error) < 0)
		fail(&error);
	for (uint32_t i = 0; i < bench->goal->n; i++) {
		const struct engine_request request = {i ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL,
											   (double)i / bench->goal->n};
		image.holds = 0;
		if (engine_render(bench->engine, &request, &image, &error) < 0)
			fail(&error);
	}
}

static void add(struct bench *bench, const struct engine_pass_report *pass)
{
	struct sample *sample = bench->samples;
	while (sample->name && strcmp(sample->name, pass->name) != 0)
		sample++;
	sample->name = pass->name;
	sample->runs = pass->runs;
	sample->ms[sample->count++] = pass->ms;
}

/* All frames; with `out` they are read back too. */
static void run(struct bench *bench, uint8_t *out)
{
	memset(bench->samples, 0, sizeof(bench->samples));
	bench->out = out;
	for (uint32_t i = 0; i < WARM_UP + bench->frames; i++) {
		show(bench, i);
		const struct engine_report *report = engine_get_report(bench->engine);
		for (uint32_t k = 0; k < report->pass_count && i >= WARM_UP; k++)
			add(bench, &report->passes[k]);
		bench->bytes_up = report->bytes_up;
		bench->bytes_down = report->bytes_down;
	}
}

/* ---- results ---- */

static bool is_transfer(const char *name)
{
	return strcmp(name, "upload") == 0 || strcmp(name, "put") == 0 || strcmp(name, "read") == 0;
}

static bool is_on_cpu(const char *name)
{
	return strcmp(name, "analyse") == 0 || strcmp(name, "field") == 0 || strcmp(name, "paint") == 0;
}

static uint64_t transferred(const struct bench *bench, const char *name)
{
	return strcmp(name, "read") == 0 ? bench->bytes_down : strcmp(name, "upload") == 0 ? bench->bytes_up : 0;
}

static void print(const struct bench *bench, const char *name, double ms, double bytes)
{
	const struct goal *goal = bench->goal;
	printf("gpu/%ux%u/%u-to-%u/%s %.4f ms", goal->width, goal->height, goal->rate, goal->rate * goal->n, name, ms);
	if (bytes > 0.0 && ms > 0.0)
		printf("  at least %.1f MB, %.1f GB/s, %.0f %% of a copy", bytes * 1e-6, bytes / ms * 1e-6,
			   100.0 * bytes / (ms * 1e-3 * bench->copy_rate));
	printf("\n");
}

/* Pictures that a pass at least reads and writes; what the pyramid touches depends on the picture: none are claimed. */
static double pictures_of(const char *name)
{
	return strcmp(name, "warp") == 0 ? 2.0 : strcmp(name, "compensate") == 0 ? 4.0 : 0.0;
}

/* What stays on the GPU. */
static void print_passes(struct bench *bench)
{
	const double picture = 4.0 * bench->goal->width * bench->goal->height;
	double total = 0.0;
	for (struct sample *sample = bench->samples; sample->name; sample++) {
		const double ms = median(sample);
		if (sample->runs > 0 && !is_transfer(sample->name) && !is_on_cpu(sample->name)) {
			print(bench, sample->name, ms, pictures_of(sample->name) * picture * sample->runs);
			total += ms;
		}
	}
	if (!(total > 0.0)) {
		fprintf(stderr, "bench-gpu: no time was measured\n");
		exit(1);
	}
	print(bench, "PASSES", total, 0.0);
	if (bench->goal->ms > 0.0)
		printf("# the goal for PASSES on a data-centre GPU is %.1f ms\n", bench->goal->ms);
}

static void print_others(struct bench *bench)
{
	for (struct sample *sample = bench->samples; sample->name; sample++) {
		const char *name = sample->name;
		char text[48];
		if (sample->runs == 0 || (!is_transfer(name) && !is_on_cpu(name)))
			continue;
		snprintf(text, sizeof(text), "%s-%s", is_transfer(name) ? "transfer" : "cpu", name);
		print(bench, text, median(sample), (double)transferred(bench, name));
	}
}

/* The analysis on the GPU instead; the rest is as before. */
static void run_analysis(struct bench *bench)
{
	struct engine_params params = bench->params;
	struct error error;
	params.analysis = ENGINE_ANALYSIS_GPU;
	if (engine_set_params(bench->engine, &params, &error) < 0)
		fail(&error);
	run(bench, NULL);
	for (struct sample *sample = bench->samples; sample->name; sample++)
		if (strcmp(sample->name, "analyse") == 0)
			print(bench, "gpu-analyse", median(sample), 0.0);
	if (engine_set_params(bench->engine, &bench->params, &error) < 0)
		fail(&error);
}

/* The same frames with both ways back. */
static void run_read(struct bench *bench)
{
	const struct bench_read read = {.engine = bench->engine,
									.pictures = bench->pictures,
									.picture_count = PICTURES,
									.n = bench->goal->n,
									.frames = bench->frames};
	struct bench_read_times times = {.waiting = 0.0};
	struct error error;
	if (bench_read(&read, &times, &error) < 0)
		fail(&error);
	print(bench, "frame-waiting", times.waiting, 0.0);
	print(bench, "frame-ahead", times.ahead, 0.0);
	printf("# ahead takes %.2f of the time of waiting; the pictures are %s\n", times.ahead / times.waiting,
		   times.equal ? "equal" : "NOT EQUAL");
	if (!times.equal)
		exit(1);
}

static void run_goal(struct bench *bench, const struct goal *goal)
{
	uint8_t *out = malloc(4 * (size_t)goal->width * goal->height);
	bench->goal = goal;
	for (uint32_t i = 0; i < PICTURES; i++) {
		picture_init(&bench->pictures[i], goal->width, goal->height, PURSUIT_FORMAT_BGRA8,
					 PICTURE_DEPTH | PICTURE_MOTION);
		picture_draw_layers(&bench->pictures[i], i);
	}
	run(bench, NULL);
	print_passes(bench);
	run(bench, out);
	print_others(bench);
	run_read(bench);
	run_analysis(bench);
	fflush(stdout);
	for (uint32_t i = 0; i < PICTURES; i++)
		picture_finish(&bench->pictures[i]);
	free(out);
}

/* On a GPU, or on what there is. */
static void make_engine(struct bench *bench, bool allow_software)
{
	struct error error;
	bench->engine = engine_create(&bench->params, &error);
	if (!bench->engine)
		fail(&error);
	const struct engine_info *info = engine_get_info(bench->engine);
	if (!info->software)
		return;
	if (!allow_software) {
		printf("skipped: there is no GPU with EGL here, the renderer is software (%s)\n", info->renderer);
		engine_destroy(&bench->engine);
		exit(SKIPPED);
	}
	engine_destroy(&bench->engine);
	bench->params.context = ENGINE_CONTEXT_EGL_SURFACELESS;
	bench->params.query_software = bench->params.buffer_software = true;
	bench->engine = engine_create(&bench->params, &error);
	if (!bench->engine) {
		printf("skipped: there is no EGL here: %s\n", error.text);
		exit(SKIPPED);
	}
}

int main(int argc, char **argv)
{
	static struct bench bench;
	bool allow_software = false, quick = false;
	struct error error;
	for (int i = 1; i < argc; i++) {
		allow_software |= strcmp(argv[i], "--allow-software") == 0;
		quick |= strcmp(argv[i], "--quick") == 0;
	}
	make_engine(&bench, allow_software);
	bench.frames = quick ? 2 : FRAMES;
	bench.copy_rate = bench_copy_rate(&bench.params, quick ? 256 : 4096, &error);
	if (bench.copy_rate < 0.0)
		fail(&error);
	const struct engine_info *info = engine_get_info(bench.engine);
	printf("# %s, times by %s%s\n", info->renderer, engine_get_report(bench.engine)->time_source,
		   info->software ? "; a SOFTWARE renderer: these figures tell nothing about a GPU" : "");
	printf("gpu/copy %.1f GB/s\n", bench.copy_rate * 1e-9);
	if (quick)
		run_goal(&bench, &quick_goal);
	for (size_t i = 0; i < sizeof(goals) / sizeof(goals[0]) && !quick; i++)
		run_goal(&bench, &goals[i]);
	engine_destroy(&bench.engine);
	return 0;
}
