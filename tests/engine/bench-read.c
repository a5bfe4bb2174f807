/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/engine/bench-read.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/now.h"

#define ROUNDS 5
/* Two are under way, and what is shown stays where it is. */
#define MEMORIES 3u

struct run {
	const struct bench_read *bench;
	uint8_t *out[MEMORIES];
	uint64_t hash; /* of all pictures */
	uint32_t asked, taken;
	bool ahead;
	bool looks; /* at the pictures, which takes time */
};

static size_t bytes_of(const struct run *run)
{
	return 4 * (size_t)run->bench->pictures->width * run->bench->pictures->height;
}

static void look(struct run *run, const uint8_t *data)
{
	for (size_t i = 0; i < bytes_of(run) && run->looks; i += 4) {
		uint32_t pixel;
		memcpy(&pixel, data + i, 4);
		run->hash = (run->hash ^ pixel) * UINT64_C(0x100000001b3);
	}
}

static int take(struct run *run, struct error *error)
{
	struct engine_image image;
	const int result = engine_take(run->bench->engine, &image, error);
	run->taken++;
	if (result == 0)
		look(run, image.data);
	return result;
}

static int show(struct run *run, const struct engine_request *request, struct error *error)
{
	struct engine_image image = {.data = run->out[run->asked % MEMORIES],
								 .stride = 4 * (size_t)run->bench->pictures->width,
								 .unfinished = run->ahead};
	int result = run->ahead && run->asked - run->taken == ENGINE_MAX_UNFINISHED ? take(run, error) : 0;
	if (result == 0)
		result = engine_render(run->bench->engine, request, &image, error);
	run->asked++;
	if (result == 0 && !run->ahead)
		look(run, image.data);
	return result;
}

/* Milliseconds a real frame; negative: an errno. */
static double time_round(struct run *run, bool ahead, uint32_t frames, struct error *error)
{
	const struct bench_read *bench = run->bench;
	const struct engine_begin_params begin = {.n = bench->n, .last_phase = -1.0};
	const uint64_t began = now_ns();
	int result = 0;
	run->ahead = ahead;
	run->asked = run->taken = 0;
	run->hash = UINT64_C(0xcbf29ce484222325);
	for (uint32_t i = 0; i < frames && result == 0; i++) {
		result = engine_begin(bench->engine, &bench->pictures[i % bench->picture_count].frame, &begin, error);
		for (uint32_t k = 0; k < bench->n && result == 0; k++) {
			const struct engine_request request = {k ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL, (double)k / bench->n};
			result = show(run, &request, error);
		}
	}
	while (ahead && result == 0 && run->taken < run->asked)
		result = take(run, error);
	return result < 0 ? result : (double)(now_ns() - began) * 1e-6 / frames;
}

static int compare(struct run *run, struct bench_read_times *times, struct error *error)
{
	uint64_t hash[2];
	for (int way = 0; way < 2; way++) {
		run->looks = true;
		const double ms = time_round(run, way == 1, run->bench->picture_count, error);
		if (ms < 0.0)
			return (int)ms;
		hash[way] = run->hash;
	}
	times->equal = hash[0] == hash[1];
	run->looks = false;
	for (int i = 0; i < 2 * ROUNDS; i++) {
		double *least = i % 2 ? &times->ahead : &times->waiting;
		const double ms = time_round(run, i % 2, run->bench->frames, error);
		if (ms < 0.0)
			return (int)ms;
		*least = i < 2 || ms < *least ? ms : *least;
	}
	return 0;
}

int bench_read(const struct bench_read *bench, struct bench_read_times *times, struct error *error)
{
	struct run run = {.bench = bench};
	int result = 0;
	for (uint32_t i = 0; i < MEMORIES; i++)
		run.out[i] = malloc(bytes_of(&run));
	if (!run.out[0] || !run.out[1] || !run.out[2])
		result = error_set(error, -ENOMEM, "out of memory");
	if (result == 0)
		result = compare(&run, times, error);
	engine_drop(bench->engine);
	for (uint32_t i = 0; i < MEMORIES; i++)
		free(run.out[i]);
	return result;
}
