/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The quality governor with simulated costs. */

#include "daemon/governor.h"
#include "tests/test.h"

#define MS 1000000.0

/* 40 frames a second on 120 Hz: 25 ms for a real frame and two in-betweens. */
struct scene {
	struct governor governor;
	double costs[GOVERNOR_LEVELS]; /* ms for one real frame with all that belongs to it, by level */
	uint64_t now_ns;
	uint32_t late;       /* in-betweens that were late, ever */
	uint32_t late_every; /* so many real frames one is late whatever it costs; 0: none */
};

static bool is_late(const struct scene *scene, int frame)
{
	return scene->late_every && (uint32_t)frame % scene->late_every == 0;
}

static void play(struct scene *scene, double seconds)
{
	for (int i = 0; i < seconds * 40; i++) {
		const double work_ms = scene->costs[scene->governor.level];
		const struct governor_sample sample = {.now_ns = scene->now_ns += 25000000,
											   .work_ns = (uint64_t)(work_ms * MS),
											   .time_ns = 25000000,
											   .late_in_betweens = work_ms > 25 || is_late(scene, i) ? 1 : 0};
		scene->late += sample.late_in_betweens;
		governor_add(&scene->governor, &sample);
	}
}

static struct scene begin(double full, double coarse, double plain, double fewer, double hold)
{
	struct scene scene = {.costs = {full, coarse, plain, fewer, hold}, .now_ns = 1000000000};
	governor_init(&scene.governor, true, 0);
	return scene;
}

static void test_what_fits_is_left_alone(void)
{
	struct scene scene = begin(21, 18, 15, 10, 6);
	play(&scene, 60);
	CHECK_INT(scene.governor.level, 0);
	CHECK_INT(scene.governor.raised + scene.governor.lowered, 0);
	CHECK_INT(scene.governor.frames_at[0], 2400);
}

/* Before it does not fit any more (0.9), not after. */
static void test_it_gives_way_before_anything_is_late(void)
{
	struct scene scene = begin(15, 14, 12, 10, 6);
	play(&scene, 2);
	scene.costs[0] = 24;
	play(&scene, 1);
	CHECK_INT(scene.governor.level, 1);
	CHECK_INT(scene.late, 0);
}

/* One level after the other, as far as needed and no further, in half a second a level. */
static void test_the_order(void)
{
	static const double too_much = 60;
	for (uint32_t needed = 1; needed < GOVERNOR_LEVELS; needed++) {
		struct scene scene = begin(15, 15, 15, 15, 15);
		uint32_t before = 0;
		play(&scene, 2);
		for (uint32_t level = 0; level < needed; level++)
			scene.costs[level] = too_much;
		for (int i = 0; i < 40; i++) {
			play(&scene, 0.025);
			CHECK(scene.governor.level == before || scene.governor.level == before + 1);
			before = scene.governor.level;
		}
		CHECK_INT(scene.governor.level, needed);
		CHECK_INT(scene.governor.raised, needed);
	}
}

static void test_no_level_is_enough(void)
{
	struct scene scene = begin(90, 80, 70, 60, 50);
	play(&scene, 100);
	CHECK_INT(scene.governor.level, GOVERNOR_LEVELS - 1);
	CHECK_INT(scene.governor.raised, GOVERNOR_LEVELS - 1);
	CHECK_INT(scene.governor.lowered, 0);
}

static void test_it_recovers(void)
{
	struct scene scene = begin(60, 55, 50, 40, 10);
	play(&scene, 5);
	CHECK(scene.governor.level == 4);
	for (uint32_t level = 0; level < GOVERNOR_LEVELS; level++)
		scene.costs[level] = 10;
	play(&scene, 60);
	CHECK_INT(scene.governor.level, 0);
}

/* Some are late although there is time: not enough to go up for, and no reason to try more. */
static void test_late_ones_keep_it_where_it_is(void)
{
	struct scene scene = begin(60, 10, 10, 10, 10);
	play(&scene, 0.5);
	CHECK_INT(scene.governor.level, 1);
	scene.costs[0] = 10;
	scene.late_every = 12;
	play(&scene, 60);
	CHECK_INT(scene.governor.level, 1);
	CHECK_INT(scene.governor.lowered, 0);
	scene.late_every = 0;
	play(&scene, 60);
	CHECK_INT(scene.governor.level, 0);
}

/* The level below is too dear, this one cheap: it is tried again, but ever less often. */
static void test_it_does_not_swing(void)
{
	struct scene scene = begin(40, 12, 10, 8, 6);
	play(&scene, 600);
	CHECK_INT(scene.governor.level, 1);
	CHECK(scene.governor.lowered >= 10);
	CHECK(scene.governor.lowered <= 600 / 32 + 8);
	CHECK(scene.governor.frames_at[0] < 600);
	CHECK(scene.late < 24000 / 40);
}

/* Lateness counts as well as load: short times that are badly distributed. */
static void test_late_in_betweens(void)
{
	for (uint32_t busy = 0; busy < 2; busy++) {
		struct governor governor;
		governor_init(&governor, true, 0);
		for (uint32_t i = 0; i < 16; i++) {
			const struct governor_sample sample = {.now_ns = i * 25000000ull,
												   .work_ns = busy ? 15000000 : 5000000,
												   .time_ns = 25000000,
												   .late_in_betweens = i % 4 == 3};
			governor_add(&governor, &sample);
		}
		CHECK_INT(governor.level, busy); /* with so little work something else is to blame */
	}
}

static void test_fixed_and_least(void)
{
	struct scene scene = begin(90, 90, 90, 90, 90);
	governor_init(&scene.governor, false, 2);
	play(&scene, 10);
	CHECK_INT(scene.governor.level, 2);
	scene = begin(1, 1, 1, 1, 1);
	governor_init(&scene.governor, true, 3);
	play(&scene, 100);
	CHECK_INT(scene.governor.level, 3);
	governor_init(&scene.governor, true, 77);
	CHECK_INT(scene.governor.level, GOVERNOR_LEVELS - 1);
}

static void test_levels(void)
{
	struct engine_params params = {0};
	governor_apply(0, &params);
	CHECK(params.cell == 0 && params.blur == ENGINE_BLUR_DOUBTFUL && !params.no_compensation);
	governor_apply(1, &params);
	CHECK(params.cell == 16 && params.blur == ENGINE_BLUR_DOUBTFUL && !params.no_compensation);
	governor_apply(2, &params);
	CHECK(params.cell == 32 && params.blur == ENGINE_BLUR_OFF && params.no_compensation);
	params.cell = 64;
	governor_apply(3, &params);
	CHECK_INT(params.cell, 64);
	CHECK(params.method == NULL);
	governor_apply(4, &params);
	CHECK_STRING(params.method, "hold");
	for (uint64_t k = 1; k < 8; k++) {
		CHECK(governor_draws(0, k) && governor_draws(2, k) && !governor_draws(4, k));
		CHECK_INT(governor_draws(3, k), k % 2);
	}
	CHECK_STRING(governor_level_name(0), "full");
	CHECK_STRING(governor_level_name(4), "hold");
	CHECK_STRING(governor_level_name(5), "");
}

static void test_nonsense(void)
{
	static const uint64_t values[] = {0, 1, UINT64_MAX, INT64_MAX, 25000000, 1000};
	struct governor governor;
	uint32_t state = 1;
	governor_init(&governor, true, 0);
	for (int i = 0; i < 20000; i++) {
		state = state * 1664525u + 1013904223u;
		const struct governor_sample sample = {values[(state >> 24) % 6], values[(state >> 16) % 6],
											   values[(state >> 8) % 6], state >> 30};
		CHECK(governor_add(&governor, &sample) < GOVERNOR_LEVELS);
		CHECK(isfinite(governor.load));
	}
}

int main(void)
{
	RUN(test_what_fits_is_left_alone);
	RUN(test_it_gives_way_before_anything_is_late);
	RUN(test_the_order);
	RUN(test_no_level_is_enough);
	RUN(test_it_recovers);
	RUN(test_late_ones_keep_it_where_it_is);
	RUN(test_it_does_not_swing);
	RUN(test_late_in_betweens);
	RUN(test_fixed_and_least);
	RUN(test_levels);
	RUN(test_nonsense);
	return test_result();
}
