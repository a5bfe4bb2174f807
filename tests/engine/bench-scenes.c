/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Milliseconds of the engine for a real frame with its in-betweens, on every scene, at the sizes and rates that the
 * project has set itself goals for. The least of the frames is what a machine with nothing else to do would show.
 *
 *   bench-scenes [CONTEXT [METHOD [WIDTHxHEIGHT]]]    CONTEXT: auto, cpu, surfaceless, osmesa, all-cpu: nothing left
 *                                                     out, ...
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/cli/scene_source.h"
#include "tests/engine/bench-clock.h"

#define FRAMES 6u
#define FIRST 45u /* index of the first frame: all scenes are in full motion */

static const struct goal {
	uint32_t width, height, rate, n;
} goals[] = {{640, 360, 60, 2}, {960, 540, 60, 2}, {1280, 720, 60, 2}, {1024, 1024, 40, 3}, {1920, 1080, 60, 2}};

static void fail(const struct error *error)
{
	fprintf(stderr, "bench-scenes: %s\n", error->text);
	exit(1);
}

/* Frames with memory of their own, so that the scene and its context can go. */
static void render(const struct goal *goal, const char *scene, struct frame frames[FRAMES])
{
	struct error error;
	const struct scene_source_params params = {
		.scene = scene, .size = {goal->width, goal->height}, .rate = {goal->rate, 1}};
	struct scene_source *source = scene_source_create(&params, &error);
	if (!source)
		fail(&error);
	for (uint32_t i = 0; i < FRAMES; i++) {
		struct frame frame;
		if (!scene_source_frame(source, FIRST + i, &frame))
			abort();
		frames[i] = frame;
		for (uint32_t k = 0; k < frame.header.plane_count; k++) {
			uint8_t *copy = aligned_alloc(64, (frame.header.planes[k].size + 63) / 64 * 64);
			memcpy(copy, frame.planes[k], frame.header.planes[k].size);
			frames[i].planes[k] = copy;
		}
	}
	scene_source_destroy(&source);
}

static void forget(struct frame frames[FRAMES])
{
	for (uint32_t i = 0; i < FRAMES; i++)
		for (uint32_t k = 0; k < frames[i].header.plane_count; k++) {
			uint8_t *gone;
			memcpy(&gone, &frames[i].planes[k], sizeof(gone));
			free(gone);
		}
}

static void print(const struct goal *goal, const char *name, const struct bench_times *times)
{
	printf("scenes/%ux%u/%u-to-%u/%s %.2f ms  least %.2f  cpu %.2f  memcpy %.2f  times a memcpy %.1f\n", goal->width,
		   goal->height, goal->rate, goal->rate * goal->n, name, times->median, times->least, times->cpu, times->copy,
		   times->median / times->copy);
	fflush(stdout);
}

static void run(const struct goal *goal, const char *context, const char *method)
{
	struct bench_times mean = {0};
	double count = 0.0;
	for (const struct scene_info *info = scene_list(); info->name; info++, count++) {
		struct frame frames[FRAMES];
		render(goal, info->name, frames);
		struct engine *engine = bench_engine(context, method);
		struct bench_times times = bench_time(engine, frames, FRAMES, goal->n, false);
		print(goal, info->name, &times);
		engine_destroy(&engine);
		forget(frames);
		mean.median += times.median;
		mean.least += times.least;
		mean.cpu += times.cpu;
		mean.copy += times.copy;
	}
	mean = (struct bench_times){mean.median / count, mean.least / count, mean.cpu / count, mean.copy / count};
	print(goal, "MEAN", &mean);
}

int main(int argc, char **argv)
{
	const char *context = argc > 1 ? argv[1] : "cpu", *method = argc > 2 ? argv[2] : NULL;
	for (size_t i = 0; i < sizeof(goals) / sizeof(goals[0]); i++) {
		char name[32];
		snprintf(name, sizeof(name), "%ux%u", goals[i].width, goals[i].height);
		if (argc <= 3 || strcmp(argv[3], name) == 0)
			run(&goals[i], context, method);
	}
	return 0;
}
