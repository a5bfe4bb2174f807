/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What memory the engine takes on the CPU: that it tells all of it, that it is at most 60 MB for 1920x1080 on every
 * scene, and that it does not grow.
 *
 *   engine-memory [FRAMES SECONDS]    with numbers: so many frames at 160x90, then so many seconds at 1920x1080, and
 * what the process has in memory before and after
 */
#include "tests/test.h"

#include <malloc.h>
#include <time.h>
#include <unistd.h>

#include "daemon/cli/scene_source.h"
#include "daemon/engine/engine.h"
#include "tests/engine/picture.h"

#define MB UINT64_C(1000000)
#define FRAMES 3u
#define FIRST 45u /* index of the first frame: all scenes are in full motion */
#define RATE 60u

struct run {
	struct engine *engine;
	uint32_t width, height;
	struct frame frames[FRAMES];
	uint8_t *out;
};

static struct engine *make_with(struct engine_params params)
{
	struct error error;
	params.context = ENGINE_CONTEXT_CPU;
	params.threads = 2;
	return engine_create(&params, &error);
}

static struct engine *make(void)
{
	return make_with((struct engine_params){0});
}

static bool render(struct run *run, const char *scene)
{
	struct error error;
	const struct scene_source_params params = {.scene = scene, .size = {run->width, run->height}, .rate = {RATE, 1}};
	struct scene_source *source = scene_source_create(&params, &error);
	for (uint32_t i = 0; i < FRAMES && source; i++) {
		if (!scene_source_frame(source, FIRST + i, &run->frames[i]))
			return false;
		for (uint32_t k = 0; k < run->frames[i].header.plane_count; k++) {
			const size_t size = run->frames[i].header.planes[k].size;
			run->frames[i].planes[k] = memcpy(malloc(size), run->frames[i].planes[k], size);
		}
	}
	scene_source_destroy(&source);
	return source == NULL && run->frames[0].header.plane_count > 0;
}

static void forget(struct run *run)
{
	for (uint32_t i = 0; i < FRAMES; i++)
		for (uint32_t k = 0; k < run->frames[i].header.plane_count; k++) {
			uint8_t *gone;
			memcpy(&gone, &run->frames[i].planes[k], sizeof(gone));
			free(gone);
		}
	memset(run->frames, 0, sizeof(run->frames));
}

/* Two vblanks a frame, into memory. */
static void show(struct run *run, uint32_t i)
{
	struct error error;
	const struct engine_begin_params begin = {.n = 2, .last_phase = -1.0};
	CHECK_INT(engine_begin(run->engine, &run->frames[i % FRAMES], &begin, &error), 0);
	for (int k = 0; k < 2; k++) {
		const struct engine_request request = {k ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL, 0.5 * k};
		struct engine_image image = {.data = run->out, .stride = 4 * (size_t)run->width};
		CHECK_INT(engine_render(run->engine, &request, &image, &error), 0);
	}
}

static uint64_t told(const struct run *run)
{
	const struct engine_report *report = engine_get_report(run->engine);
	return report->memory_bytes + report->plan_bytes;
}

/* What malloc() has given away; 0 where something else stands in its place. */
static uint64_t allocated(void)
{
	const struct mallinfo2 info = mallinfo2();
	return info.uordblks + info.hblkhd;
}

static void check_scene(const char *scene)
{
	struct run run = {.width = 1920, .height = 1080, .out = malloc((size_t)4 * 1920 * 1080)};
	CHECK(render(&run, scene));
	const uint64_t before = allocated();
	run.engine = make();
	for (uint32_t i = 0; i < FRAMES; i++)
		show(&run, i);
	const uint64_t bytes = told(&run), real = allocated() - before;
	printf("%s at 1920x1080: %.1f MB told, %.1f MB allocated\n", scene, (double)bytes * 1e-6, (double)real * 1e-6);
	CHECK(bytes <= 60 * MB);
	if (before)
		CHECK(real <= bytes + bytes / 50 + 100000 && bytes <= real + real / 50);
	for (uint32_t i = 0; i < 2 * FRAMES; i++)
		show(&run, i);
	CHECK_INT((long)told(&run), (long)bytes);
	engine_destroy(&run.engine);
	forget(&run);
	free(run.out);
}

static void test_scenes(void)
{
	for (const struct scene_info *info = scene_list(); info->name; info++)
		check_scene(info->name);
}

/* All planes, a UI everywhere, everything in motion, and settings that leave nothing out. */
static void check_worst(const char *name, const struct engine_params *params)
{
	struct run run = {.engine = make_with(*params), .width = 1920, .height = 1080};
	struct picture pictures[FRAMES];
	run.out = malloc((size_t)4 * 1920 * 1080);
	for (uint32_t i = 0; i < FRAMES; i++) {
		picture_init(&pictures[i], 1920, 1080, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH | PICTURE_UI);
		picture_draw_layers(&pictures[i], i);
		for (uint32_t y = 0; y < 1080; y++)
			memset(picture_row(&pictures[i], PURSUIT_ROLE_UI, y), 0x40, (size_t)4 * 1920);
		run.frames[i] = pictures[i].frame;
	}
	for (uint32_t i = 0; i < 2 * FRAMES; i++)
		show(&run, i);
	const struct engine_report *report = engine_get_report(run.engine);
	const uint64_t bytes = report->memory_bytes + report->plan_bytes;
	printf("%s at 1920x1080: %.1f MB told, of which %.1f for the plan\n", name, (double)bytes * 1e-6,
		   (double)report->plan_bytes * 1e-6);
	CHECK(bytes <= 60 * MB);
	for (uint32_t i = 0; i < 2 * FRAMES; i++)
		show(&run, i);
	CHECK_INT((long)told(&run), (long)bytes);
	for (uint32_t i = 0; i < FRAMES; i++)
		picture_finish(&pictures[i]);
	engine_destroy(&run.engine);
	free(run.out);
}

static void test_worst(void)
{
	struct engine_params params = {.blur = ENGINE_BLUR_EVERYWHERE};
	check_worst("UI, blurred everywhere", &params);
	params.cell = 4;
	check_worst("UI, blurred everywhere, cells of 4", &params);
	params.cell = 0;
	params.motion_model = ENGINE_MOTION_QUADRATIC;
	check_worst("UI, blurred everywhere, quadratic", &params);
}

/* Sizes that come and go: what has grown for the largest stays, and no more. */
static void test_sizes(void)
{
	static const uint32_t sizes[][2] = {{320, 180}, {64, 64}, {640, 360}, {200, 600}, {640, 360}};
	struct run run = {.engine = make(), .out = malloc((size_t)4 * 640 * 600)};
	uint64_t most = 0;
	for (int round = 0; round < 3; round++) {
		for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
			run.width = sizes[i][0];
			run.height = sizes[i][1];
			CHECK(render(&run, "creature"));
			for (uint32_t k = 0; k < FRAMES; k++)
				show(&run, k);
			forget(&run);
		}
		CHECK(round < 1 || told(&run) == most);
		most = told(&run);
	}
	engine_destroy(&run.engine);
	free(run.out);
}

static double resident_mb(void)
{
	long pages = 0;
	FILE *file = fopen("/proc/self/statm", "r");
	if (!file || fscanf(file, "%*d %ld", &pages) != 1)
		pages = 0;
	if (file)
		fclose(file);
	return (double)pages * (double)sysconf(_SC_PAGESIZE) * 1e-6;
}

static double now_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static void endure(uint32_t width, uint32_t height, uint64_t frames, double seconds)
{
	struct run run = {.engine = make(), .width = width, .height = height, .out = malloc((size_t)4 * width * height)};
	CHECK(render(&run, "creature"));
	const double began = now_s();
	double first = 0.0;
	uint64_t done = 0;
	for (; done < frames || now_s() - began < seconds; done++) {
		if (done == 100)
			first = resident_mb();
		show(&run, (uint32_t)(done % FRAMES));
	}
	printf("%ux%u, %llu frames in %.0f s: %.1f MB resident after 100 frames, %.1f at the end; the engine tells %.1f\n",
		   width, height, (unsigned long long)done, now_s() - began, first, resident_mb(), (double)told(&run) * 1e-6);
	fflush(stdout);
	engine_destroy(&run.engine);
	forget(&run);
	free(run.out);
}

int main(int argc, char **argv)
{
	struct run run = {.width = 64, .height = 64};
	if (!render(&run, "still")) {
		printf("no GL to render scenes with\n");
		return 77;
	}
	forget(&run);
	if (argc > 2) {
		endure(160, 90, strtoull(argv[1], NULL, 10), 0.0);
		endure(1920, 1080, 101, strtod(argv[2], NULL));
		return test_result();
	}
	RUN(test_scenes);
	RUN(test_worst);
	RUN(test_sizes);
	return test_result();
}
