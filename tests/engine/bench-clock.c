/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/engine/bench-clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#define WARM_UP 9 /* until each image holds something */
#define IMAGES 4u /* as many as presenters have in turn */

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

static void sort(double values[BENCH_FRAMES])
{
	qsort(values, BENCH_FRAMES, sizeof(*values), compare);
}

static void fail(const struct error *error)
{
	fprintf(stderr, "%s\n", error->text);
	exit(1);
}

static void show(struct engine *engine, const struct frame *frame, uint32_t n, struct engine_image images[IMAGES],
				 uint32_t *next)
{
	struct error error;
	const struct engine_begin_params begin = {.n = n, .last_phase = -1.0};
	if (engine_begin(engine, frame, &begin, &error) < 0)
		fail(&error);
	for (uint32_t i = 0; i < n; i++) {
		const struct engine_request request = {i ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL, (double)i / n};
		if (engine_render(engine, &request, &images[(*next)++ % IMAGES], &error) < 0)
			fail(&error);
	}
}

/* All planes once, all displayed frames once, to memory that nobody else uses. */
static void copy(const struct frame *frame, uint32_t n, size_t picture, uint8_t *in, uint8_t *out)
{
	for (uint32_t i = 0; i < frame->header.plane_count; i++)
		memcpy(in, frame->planes[i], frame->header.planes[i].size);
	for (uint32_t i = 0; i < n; i++)
		memcpy(out + i * picture, in, picture);
}

static size_t largest_plane(const struct frame *frame)
{
	size_t largest = 0;
	for (uint32_t i = 0; i < frame->header.plane_count; i++)
		if (frame->header.planes[i].size > largest)
			largest = frame->header.planes[i].size;
	return largest;
}

/* The frame as that of a client's stream; `unchanged`: of one that says that nothing has changed since its last. */
static struct frame next_of_stream(const struct frame *frame, uint64_t id, bool unchanged)
{
	struct frame next = *frame;
	next.stream = 1;
	next.header.frame_id = id;
	next.header.damage_since = id - 1;
	next.header.flags |= unchanged && id > 1 ? PURSUIT_FRAME_DAMAGE : 0;
	return next;
}

struct bench_times bench_time(struct engine *engine, const struct frame *frames, uint32_t count, uint32_t n,
							  bool unchanged)
{
	const size_t picture = 4 * (size_t)frames->header.planes[0].width * frames->header.planes[0].height;
	const size_t stride = picture / frames->header.planes[0].height;
	uint8_t *in = malloc(largest_plane(frames)), *copies = malloc(n * picture), *out = malloc(IMAGES * picture);
	double wall[BENCH_FRAMES], cpu[BENCH_FRAMES], copied[BENCH_FRAMES];
	struct engine_image images[IMAGES];
	uint32_t shown = 0;
	for (uint32_t i = 0; i < IMAGES; i++)
		images[i] = (struct engine_image){.data = out + i * picture, .stride = stride};
	memset(in, 0, largest_plane(frames));
	for (int i = -WARM_UP; i < BENCH_FRAMES; i++) {
		const uint32_t id = (uint32_t)(i + WARM_UP);
		const struct frame next = next_of_stream(&frames[unchanged ? 0 : id % count], id + 1, unchanged);
		const struct frame *frame = &next;
		double began = now_ms(CLOCK_MONOTONIC), cpu_began = now_ms(CLOCK_PROCESS_CPUTIME_ID);
		show(engine, frame, n, images, &shown);
		double ended = now_ms(CLOCK_MONOTONIC), cpu_ended = now_ms(CLOCK_PROCESS_CPUTIME_ID);
		copy(frame, n, picture, in, copies);
		if (i < 0)
			continue;
		wall[i] = ended - began;
		cpu[i] = cpu_ended - cpu_began;
		copied[i] = now_ms(CLOCK_MONOTONIC) - ended;
	}
	sort(wall);
	sort(cpu);
	sort(copied);
	free(in);
	free(copies);
	free(out);
	return (struct bench_times){wall[BENCH_FRAMES / 2], wall[0], cpu[0], copied[BENCH_FRAMES / 2]};
}

struct engine *bench_engine(const char *context, const char *method)
{
	static const char *const names[] = {"auto", "surfaceless", "device", "osmesa", "cpu"};
	const bool all = strncmp(context, "all-", 4) == 0;
	struct engine_params params = {.method = method, .leave_nothing_out = all};
	struct error error;
	for (uint32_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
		if (strcmp(names[i], context + (all ? 4 : 0)) == 0)
			params.context = (enum engine_context_kind)i;
	struct engine *engine = engine_create(&params, &error);
	if (!engine)
		fail(&error);
	return engine;
}

double bench_most_memory(void)
{
	struct rusage usage;
	getrusage(RUSAGE_SELF, &usage);
	return (double)usage.ru_maxrss / 1024.0;
}
