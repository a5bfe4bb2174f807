/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The cost of a real frame with its in-betweens against the share of the picture that moves, and of a still picture;
 * with the straight line that fits best, and the memory that the process has taken.
 *
 *   bench-share [CONTEXT [METHOD]]
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/engine/bench-clock.h"
#include "tests/engine/picture.h"

#define PICTURES 3u
#define STEPS 10u

struct line {
	double n, x, y, xx, xy;
};

static void add(struct line *line, double x, double y)
{
	line->n += 1.0;
	line->x += x;
	line->y += y;
	line->xx += x * x;
	line->xy += x * y;
}

/* What lies right of the moving share does not move. */
static void still(const struct picture *picture, double share)
{
	uint32_t from = (uint32_t)(share * picture->width);
	for (uint32_t y = 0; y < picture->height; y++)
		memset(picture_row(picture, PURSUIT_ROLE_MOTION, y) + 8 * (size_t)from, 0, 8 * (size_t)(picture->width - from));
}

static void run(const char *context, const char *method, uint32_t width, uint32_t height, uint32_t n)
{
	struct engine *engine = bench_engine(context, method);
	struct line line = {0};
	for (uint32_t step = 0; step <= STEPS; step++) {
		struct picture pictures[PICTURES];
		struct frame frames[PICTURES];
		double share = (double)step / STEPS;
		for (uint32_t i = 0; i < PICTURES; i++) {
			picture_init(&pictures[i], width, height, PURSUIT_FORMAT_BGRA8, PICTURE_DEPTH | PICTURE_MOTION);
			picture_draw_layers(&pictures[i], i);
			still(&pictures[i], share);
			frames[i] = pictures[i].frame;
		}
		struct bench_times times = bench_time(engine, frames, PICTURES, n, false);
		printf("share/%ux%u/n%u/%u%% %.2f ms  least %.2f  cpu %.2f  memcpy %.2f\n", width, height, n, 10 * step,
			   times.median, times.least, times.cpu, times.copy);
		fflush(stdout);
		add(&line, share, times.least);
		for (uint32_t i = 0; i < PICTURES; i++)
			picture_finish(&pictures[i]);
	}
	double slope = (line.n * line.xy - line.x * line.y) / (line.n * line.xx - line.x * line.x);
	printf("share/%ux%u/n%u/fit of the least: %.2f ms + %.2f ms x share; memory at most %.0f MB\n", width, height, n,
		   (line.y - slope * line.x) / line.n, slope, bench_most_memory());
	engine_destroy(&engine);
}

static void rest(const char *context, const char *method, uint32_t width, uint32_t height)
{
	struct engine *engine = bench_engine(context, method);
	struct picture picture;
	picture_init(&picture, width, height, PURSUIT_FORMAT_BGRA8, PICTURE_DEPTH | PICTURE_MOTION);
	picture_draw_layers(&picture, 0.0);
	still(&picture, 0.0);
	for (int unchanged = 0; unchanged < 2; unchanged++) {
		struct bench_times times = bench_time(engine, &picture.frame, 1, 2, unchanged);
		printf("still/%ux%u/n2/%s %.3f ms  least %.3f  cpu %.3f  memcpy %.2f\n", width, height,
			   unchanged ? "declared" : "found by looking", times.median, times.least, times.cpu, times.copy);
	}
	picture_finish(&picture);
	engine_destroy(&engine);
}

int main(int argc, char **argv)
{
	const char *context = argc > 1 ? argv[1] : "cpu", *method = argc > 2 ? argv[2] : NULL;
	rest(context, method, 1920, 1080);
	run(context, method, 640, 360, 2);
	run(context, method, 1024, 1024, 3);
	run(context, method, 1920, 1080, 2);
	return 0;
}
