/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Milliseconds per frame of each scene (or of those named), one line each:
 *   scene SIZE NAME cpu MS p50 MS p99 MS create MS
 * cpu is the median of the processor time of all threads, which a busy machine disturbs least.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "client/scenes/scene.h"
#include "context.h"

enum { FRAMES = 60 };

static double now_ms(clockid_t clock)
{
	struct timespec t;
	clock_gettime(clock, &t);
	return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static void (*finish)(void);

static void bench(const char *name, uint32_t width, uint32_t height)
{
	char error[256];
	double times[FRAMES], cpu[FRAMES], start = now_ms(CLOCK_MONOTONIC);
	struct scene *scene = scene_create(name, width, height, test_context_lookup, error, sizeof(error));
	if (!scene) {
		printf("scene %ux%u %s: %s\n", width, height, name, error);
		return;
	}
	double create = now_ms(CLOCK_MONOTONIC) - start;
	struct scene_textures textures;
	for (int i = -4; i < FRAMES; i++) {
		double time = 3.0 + i * 0.31;
		struct scene_request request = {.time = time, .time_previous = time - 1.0 / 60.0};
		double before = now_ms(CLOCK_MONOTONIC), cpu_before = now_ms(CLOCK_PROCESS_CPUTIME_ID);
		scene_render(scene, &request, &textures, NULL);
		finish();
		if (i < 0)
			continue;
		times[i] = now_ms(CLOCK_MONOTONIC) - before;
		cpu[i] = now_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_before;
	}
	qsort(cpu, FRAMES, sizeof(cpu[0]), compare);
	qsort(times, FRAMES, sizeof(times[0]), compare);
	printf("scene %ux%u %-10s least %6.2f cpu %6.2f ms p50 %6.2f ms p99 %6.2f ms create %4.0f ms\n", width, height,
		   name, cpu[0], cpu[FRAMES / 2], times[FRAMES / 2], times[FRAMES - 1], create);
	fflush(stdout);
	scene_destroy(&scene);
}

int main(int argc, char **argv)
{
	struct test_context context;
	if (!test_context_init(&context, false))
		return 77;
	union {
		void *object;
		void (*function)(void);
	} pointer = {.object = test_context_lookup("glFinish")};
	finish = pointer.function;
	static const uint32_t sizes[2][2] = {{640, 360}, {1920, 1080}};
	for (int s = 0; s < 2; s++) {
		for (const struct scene_info *info = scene_list(); info->name; info++) {
			bool wanted = argc < 2;
			for (int i = 1; i < argc; i++)
				wanted |= strcmp(argv[i], info->name) == 0;
			if (wanted)
				bench(info->name, sizes[s][0], sizes[s][1]);
		}
	}
	test_context_finish(&context);
	return 0;
}
