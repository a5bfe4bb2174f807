/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A plan made with true damage has the bits of one made without, frame after frame, whatever came before; and one made
 * with false damage is sane, and forgotten with the next frame that says nothing.
 *
 *   test-plan-damage [SEEDS]     24 sequences of frames by default
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/pool.h"
#include "fixture.h"
#include "tests/test.h"

#define FRAMES 150u

struct sequence {
	uint32_t random;
	struct fixture fixture;
	struct fixture_spec spec;
	struct plan_params params;
	struct pursuit_rectangle moving[2], damage[4];
	uint32_t moving_count, damage_count;
	struct plan kept, anew;
	uint64_t frame_id;
	uint32_t followed; /* frames whose plan was made with damage, and moves */
};

static struct pool *pool;
static uint32_t seeds = 24;

static uint32_t pick(struct sequence *sequence, uint32_t count)
{
	return random_next(&sequence->random) % count;
}

static struct pursuit_rectangle some_rectangle(struct sequence *sequence)
{
	const uint32_t width = sequence->spec.width, height = sequence->spec.height;
	const uint32_t x = pick(sequence, width), y = pick(sequence, height);
	const uint32_t most = pick(sequence, 4) ? 1 + height / 4 : height - y;
	const uint32_t tall = most < height - y ? most : height - y;
	return (struct pursuit_rectangle){x, y, 1 + pick(sequence, width - x), 1 + pick(sequence, tall)};
}

static void fill(struct sequence *sequence, const struct pursuit_rectangle *at, bool moves, bool depths)
{
	const double x = random_quarter(&sequence->random, 9), y = random_quarter(&sequence->random, 9);
	const bool noise = pick(sequence, 3) == 0;
	for (uint32_t j = at->y; j < at->y + at->height; j++)
		for (uint32_t i = at->x; i < at->x + at->width; i++) {
			const double more = noise ? random_quarter(&sequence->random, 2) : 0.0;
			if (j < sequence->fixture.motion_plane->height)
				fixture_set_motion(&sequence->fixture, i, j, moves ? x + more : 0.0, moves ? y : 0.0);
			if (depths && sequence->fixture.depth_plane)
				fixture_set_depth(&sequence->fixture, i, j, 0.001 * pick(sequence, 1000));
		}
	if (moves && pick(sequence, 12) == 0 && at->y < sequence->fixture.motion_plane->height)
		fixture_set_motion(&sequence->fixture, at->x, at->y, (double)NAN, 1.0);
}

/* What moved stands still, other things move, or only change; all that is damage. */
static void change(struct sequence *sequence)
{
	sequence->damage_count = sequence->moving_count;
	memcpy(sequence->damage, sequence->moving, sizeof(sequence->moving));
	for (uint32_t i = 0; i < sequence->moving_count; i++)
		fill(sequence, &sequence->moving[i], false, false);
	sequence->moving_count = pick(sequence, 3);
	for (uint32_t i = 0; i < sequence->moving_count; i++) {
		sequence->moving[i] = some_rectangle(sequence);
		fill(sequence, &sequence->moving[i], pick(sequence, 4), pick(sequence, 2));
		sequence->damage[sequence->damage_count++] = sequence->moving[i];
	}
}

/* Single pixels that are no numbers, and stay. */
static void spoil(struct sequence *sequence)
{
	for (uint32_t i = pick(sequence, 3); i > 0; i--)
		fixture_set_motion(&sequence->fixture, pick(sequence, sequence->spec.width),
						   pick(sequence, sequence->fixture.motion_plane->height), (double)NAN, 0.0);
}

/* Another picture, or all of this one moves. */
static void change_all(struct sequence *sequence, bool spec)
{
	const struct pursuit_rectangle all = {0, 0, sequence->spec.width, sequence->spec.height};
	if (spec) {
		static const uint32_t sizes[][2] = {{64, 48}, {93, 131}, {40, 333}, {17, 9}, {200, 64}};
		const uint32_t *size = sizes[pick(sequence, 5)];
		fixture_finish(&sequence->fixture);
		sequence->spec = (struct fixture_spec){.width = size[0],
											   .height = size[1],
											   .motion_format = PURSUIT_FORMAT_RG16F + pick(sequence, 2),
											   .depth_format = pick(sequence, 4) ? PURSUIT_FORMAT_DEPTH32F : 0};
		if (pick(sequence, 4) == 0)
			sequence->spec.motion_height = size[1] / 2 + 1;
		fixture_make(&sequence->fixture, &sequence->spec);
		spoil(sequence);
		sequence->moving_count = 0;
	} else {
		fill(sequence, &all, pick(sequence, 2), true);
		sequence->moving[0] = all;
		sequence->moving_count = 1;
	}
}

static void change_settings(struct sequence *sequence)
{
	struct pursuit_frame_header *header = &sequence->fixture.frame.header;
	switch (pick(sequence, 12)) {
	case 0:
		sequence->params.cell = 4 + pick(sequence, 12);
		break;
	case 1:
		sequence->params.threshold_quarter = 1 + pick(sequence, 9);
		break;
	case 2:
		sequence->params.last_phase = 0.25f * (float)pick(sequence, 5);
		break;
	case 3:
		sequence->params.real_interval_ns = 8000000 + pick(sequence, 30000000);
		break;
	case 4:
		header->depth_kind =
			sequence->spec.depth_format ? PURSUIT_DEPTH_DEVICE + pick(sequence, 3) : PURSUIT_DEPTH_NONE;
		header->near_distance = 0.1f;
		header->far_distance = 1.0f + (float)pick(sequence, 2);
		break;
	default:
		break;
	}
	sequence->params.pool = pick(sequence, 2) ? pool : NULL;
	sequence->fixture.frame.volatile_memory = pick(sequence, 2);
}

static bool is_anew(struct sequence *sequence, const struct plan_params *params)
{
	struct plan_params whole = *params;
	struct error error;
	whole.damage = NULL;
	whole.pool = NULL;
	CHECK_INT(plan_make(&sequence->kept, &sequence->fixture.frame, params, &error), 0);
	CHECK_INT(plan_make(&sequence->anew, &sequence->fixture.frame, &whole, &error), 0);
	return fixture_same_plan(&sequence->kept, &sequence->anew);
}

/* A frame that the engine never got; the damage of the next one is against it. */
static void lose_one(struct sequence *sequence)
{
	const struct pursuit_rectangle place = some_rectangle(sequence);
	change(sequence);
	fill(sequence, &place, false, true);
	sequence->frame_id++;
}

static void next(struct sequence *sequence, uint32_t seed)
{
	struct pursuit_frame_header *header = &sequence->fixture.frame.header;
	struct plan_params params;
	const uint32_t what = pick(sequence, 20);
	bool told = what > 1;
	if (what < 2)
		change_all(sequence, what == 0);
	else if (what == 2)
		lose_one(sequence);
	if (what >= 2)
		change(sequence);
	change_settings(sequence);
	header->flags = what == 3 ? PURSUIT_FRAME_CUT : 0;
	header->damage_since = sequence->frame_id;
	header->frame_id = ++sequence->frame_id;
	params = sequence->params;
	params.damage = told ? sequence->damage : NULL;
	params.damage_count = sequence->damage_count;
	params.unchanged = told && sequence->damage_count == 0;
	const bool same = is_anew(sequence, &params);
	CHECK(same);
	if (!same)
		fprintf(stderr, "seed %u: frame %u has another plan\n", seed, (unsigned)header->frame_id);
	sequence->followed += told && sequence->kept.rest == PLAN_MOVES;
}

static void begin(struct sequence *sequence, uint32_t seed)
{
	*sequence = (struct sequence){
		.random = seed, .spec = {.width = 8, .height = 8}, .params = {.display_width_mm = 1, .last_phase = 0.5f}};
	fixture_make(&sequence->fixture, &sequence->spec);
	change_all(sequence, true);
}

static void end(struct sequence *sequence)
{
	plan_finish(&sequence->kept);
	plan_finish(&sequence->anew);
	fixture_finish(&sequence->fixture);
}

static void test_true_damage(void)
{
	static struct sequence sequence;
	for (uint32_t seed = 1; seed <= seeds; seed++) {
		begin(&sequence, seed);
		for (uint32_t i = 0; i < FRAMES; i++)
			next(&sequence, seed);
		CHECK(sequence.followed > FRAMES / 4);
		end(&sequence);
	}
}

/* Rectangles that have nothing to do with what changes. */
static void test_false_damage(void)
{
	static struct sequence sequence;
	for (uint32_t seed = 1; seed <= seeds; seed++) {
		begin(&sequence, seed);
		for (uint32_t i = 0; i < FRAMES; i++) {
			struct pursuit_frame_header *header = &sequence.fixture.frame.header;
			change_all(&sequence, pick(&sequence, 30) == 0);
			for (uint32_t k = 0; k < 4; k++)
				sequence.damage[k] = pick(&sequence, 9)
										 ? some_rectangle(&sequence)
										 : (struct pursuit_rectangle){pick(&sequence, 9), UINT32_MAX, 1, UINT32_MAX};
			header->damage_since = sequence.frame_id;
			header->frame_id = ++sequence.frame_id;
			const bool told = pick(&sequence, 4);
			sequence.params.damage = told ? sequence.damage : NULL;
			sequence.params.damage_count = pick(&sequence, 5);
			const bool same = is_anew(&sequence, &sequence.params);
			CHECK(same || told);
			for (uint32_t v = 0; v < sequence.kept.columns * sequence.kept.rows; v++) {
				const struct plan_vertex *vertex = &sequence.kept.vertices[v];
				if (!(vertex->z >= 0.0f && vertex->z <= 1.0f && fabsf(vertex->ux) <= 16384.0f))
					CHECK(false);
			}
		}
		end(&sequence);
	}
}

/* What moved, and now rests though its rectangle is not named, is not kept moving. */
static void test_motion_is_never_kept(void)
{
	const struct fixture_spec spec = {
		.width = 64, .height = 160, .motion_format = PURSUIT_FORMAT_RG32F, .depth_format = PURSUIT_FORMAT_DEPTH32F};
	const struct pursuit_rectangle all = {0, 0, 64, 160}, damage = {0, 80, 64, 8};
	static struct sequence sequence;
	begin(&sequence, 1);
	fixture_finish(&sequence.fixture);
	sequence.spec = spec;
	fixture_make(&sequence.fixture, &spec);
	sequence.params = (struct plan_params){.display_width_mm = 1};
	fill(&sequence, &all, true, true);
	sequence.fixture.frame.header.frame_id = 1;
	CHECK(is_anew(&sequence, &sequence.params) && sequence.kept.rest == PLAN_MOVES);
	fill(&sequence, &all, false, false);
	fixture_set_motion(&sequence.fixture, 10, 84, 3.0, 0.0);
	sequence.fixture.frame.header.frame_id = 2;
	sequence.fixture.frame.header.damage_since = 1;
	sequence.params.damage = &damage;
	sequence.params.damage_count = 1;
	CHECK(is_anew(&sequence, &sequence.params) && sequence.kept.rest == PLAN_MOVES);
	end(&sequence);
}

/* Rows that no rectangle touches are not read: that is what damage is for. */
static void test_rows_are_left_out(void)
{
	const struct fixture_spec spec = {
		.width = 64, .height = 160, .motion_format = PURSUIT_FORMAT_RG32F, .depth_format = PURSUIT_FORMAT_DEPTH32F};
	const struct pursuit_rectangle damage = {0, 80, 64, 8};
	struct plan_params params = {.cell = 8, .display_width_mm = 1};
	struct fixture fixture;
	struct plan plan = {0};
	struct error error;
	fixture_make(&fixture, &spec);
	for (uint32_t x = 0; x < 64; x++)
		fixture_set_motion(&fixture, x, 84, 3.0, 0.0);
	for (int i = 0; i < 4; i++) {
		fixture.frame.header.damage_since = i;
		fixture.frame.header.frame_id = i + 1;
		params.damage = i ? &damage : NULL;
		params.unchanged = i == 2;
		params.damage_count = params.unchanged ? 0 : 1;
		CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
		CHECK_INT(plan.rest, params.unchanged ? PLAN_UNCHANGED : PLAN_MOVES);
		/* Far from the damage: what is false there is not seen. */
		CHECK_INT((long)plan.vertices[2 * 10 + 3].ux, 0);
		CHECK_INT((long)(plan.vertices[2 * 10 + 3].z * 8.0f), 0);
		for (uint32_t y = 0; y < 24; y++)
			for (uint32_t x = 0; x < 64; x++) {
				fixture_set_motion(&fixture, x, y, 5.0, 0.0);
				fixture_set_depth(&fixture, x, y, 0.5);
			}
	}
	params.damage = NULL;
	CHECK_INT(plan_make(&plan, &fixture.frame, &params, &error), 0);
	CHECK_INT((long)plan.vertices[2 * 10 + 3].ux, 5);
	CHECK_INT((long)(plan.vertices[2 * 10 + 3].z * 8.0f), 4);
	plan_finish(&plan);
	fixture_finish(&fixture);
}

int main(int argc, char **argv)
{
	seeds = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : seeds;
	pool = pool_create(3);
	RUN(test_true_damage);
	RUN(test_false_damage);
	RUN(test_motion_is_never_kept);
	RUN(test_rows_are_left_out);
	pool_destroy(&pool);
	return test_result();
}
