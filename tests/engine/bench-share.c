/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The cost of a real frame with its in-betweens against the share of the picture that moves, and of a still picture;
 * with the straight line that fits best, and the memory that the process has taken; and against the share of its rows
 * that change, by a client that says which and by one that does not.
 *
 *   bench-share [CONTEXT [METHOD [WIDTHxHEIGHT|damage]]]
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

/* What lies right of the moving share does not move, and is in all pictures what it is in the first. */
static void still(const struct picture *picture, const struct picture *first, double share)
{
	const uint32_t from = (uint32_t)(share * picture->width), count = picture->width - from;
	for (uint32_t y = 0; y < picture->height; y++) {
		memset(picture_row(picture, PURSUIT_ROLE_MOTION, y) + 8 * (size_t)from, 0, 8 * (size_t)count);
		for (uint32_t role = PURSUIT_ROLE_COLOR; role <= PURSUIT_ROLE_DEPTH && picture != first; role++)
			memcpy(picture_row(picture, role, y) + 4 * (size_t)from, picture_row(first, role, y) + 4 * (size_t)from,
				   4 * (size_t)count);
	}
}

static void print_fit(const char *name, const char *what, const struct line *line)
{
	const double slope = (line->n * line->xy - line->x * line->y) / (line->n * line->xx - line->x * line->x);
	printf("%s/fit of the %s: %.2f ms + %.2f ms x share\n", name, what, (line->y - slope * line->x) / line->n, slope);
}

static void run(const char *context, const char *method, uint32_t width, uint32_t height, uint32_t n)
{
	struct engine *engine = bench_engine(context, method);
	struct line line = {0}, cpu = {0};
	for (uint32_t step = 0; step <= STEPS; step++) {
		struct picture pictures[PICTURES];
		struct frame frames[PICTURES];
		double share = (double)step / STEPS;
		for (uint32_t i = 0; i < PICTURES; i++) {
			picture_init(&pictures[i], width, height, PURSUIT_FORMAT_BGRA8, PICTURE_DEPTH | PICTURE_MOTION);
			picture_draw_layers(&pictures[i], i);
			still(&pictures[i], &pictures[0], share);
			frames[i] = pictures[i].frame;
		}
		struct bench_times times = bench_time(engine, frames, PICTURES, n, false);
		printf("share/%ux%u/n%u/%u%% %.2f ms  least %.2f  cpu %.2f  memcpy %.2f\n", width, height, n, 10 * step,
			   times.median, times.least, times.cpu, times.copy);
		fflush(stdout);
		add(&line, share, times.least);
		add(&cpu, share, times.cpu);
		for (uint32_t i = 0; i < PICTURES; i++)
			picture_finish(&pictures[i]);
	}
	char name[64];
	snprintf(name, sizeof(name), "share/%ux%u/n%u", width, height, n);
	print_fit(name, "least", &line);
	print_fit(name, "cpu", &cpu);
	printf("%s/memory at most %.0f MB\n", name, bench_most_memory());
	engine_destroy(&engine);
}

/* Rows below the changing share do not move, and are in all pictures what they are in the first. */
static void still_below(const struct picture *picture, const struct picture *first, uint32_t from)
{
	for (uint32_t y = from; y < picture->height; y++) {
		memset(picture_row(picture, PURSUIT_ROLE_MOTION, y), 0, 8 * (size_t)picture->width);
		for (uint32_t role = PURSUIT_ROLE_COLOR; role <= PURSUIT_ROLE_DEPTH && picture != first; role++)
			memcpy(picture_row(picture, role, y), picture_row(first, role, y), 4 * (size_t)picture->width);
	}
}

static void run_damage(const char *context, const char *method, uint32_t width, uint32_t height, uint32_t n)
{
	static const uint32_t percents[] = {1, 5, 10, 25, 50, 100};
	struct engine *engine = bench_engine(context, method);
	for (size_t step = 0; step < sizeof(percents) / sizeof(percents[0]); step++) {
		const uint32_t rows = (height * percents[step] + 99) / 100;
		struct picture pictures[PICTURES];
		struct frame frames[PICTURES];
		struct bench_times times[2];
		for (uint32_t i = 0; i < PICTURES; i++) {
			picture_init(&pictures[i], width, height, PURSUIT_FORMAT_BGRA8, PICTURE_DEPTH | PICTURE_MOTION);
			picture_draw_layers(&pictures[i], i);
			still_below(&pictures[i], &pictures[0], rows);
			frames[i] = pictures[i].frame;
		}
		for (uint32_t told = 0; told < 2; told++) {
			for (uint32_t i = 0; i < PICTURES && told; i++) {
				frames[i].header.flags |= PURSUIT_FRAME_DAMAGE;
				frames[i].header.damage_count = 1;
				frames[i].header.damage[0] = (struct pursuit_rectangle){0, 0, width, rows};
			}
			times[told] = bench_time(engine, frames, PICTURES, n, false);
		}
		printf("damage/%ux%u/n%u/%u%% told %.2f ms  least %.2f  cpu %.2f  not told %.2f ms  least %.2f  cpu %.2f\n",
			   width, height, n, percents[step], times[1].median, times[1].least, times[1].cpu, times[0].median,
			   times[0].least, times[0].cpu);
		fflush(stdout);
		for (uint32_t i = 0; i < PICTURES; i++)
			picture_finish(&pictures[i]);
	}
	engine_destroy(&engine);
}

static void rest(const char *context, const char *method, uint32_t width, uint32_t height)
{
	struct engine *engine = bench_engine(context, method);
	struct picture picture;
	picture_init(&picture, width, height, PURSUIT_FORMAT_BGRA8, PICTURE_DEPTH | PICTURE_MOTION);
	picture_draw_layers(&picture, 0.0);
	still(&picture, &picture, 0.0);
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
	static const struct size {
		uint32_t width, height, n;
	} sizes[] = {{640, 360, 2}, {1024, 1024, 3}, {1920, 1080, 2}};
	if (argc <= 3)
		rest(context, method, 1920, 1080);
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		char name[32];
		snprintf(name, sizeof(name), "%ux%u", sizes[i].width, sizes[i].height);
		if (argc <= 3 || strcmp(argv[3], name) == 0)
			run(context, method, sizes[i].width, sizes[i].height, sizes[i].n);
	}
	if (argc <= 3 || strcmp(argv[3], "damage") == 0)
		run_damage(context, method, 1920, 1080, 2);
	return 0;
}
