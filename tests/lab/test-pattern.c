/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/pattern.h"
#include "tests/test.h"

static const uint8_t shows[] = {POINTS_REAL,   POINTS_IN_BETWEEN, POINTS_IN_BETWEEN, POINTS_REAL,
								POINTS_REPEAT, POINTS_STANDBY,    POINTS_REAL,       POINTS_KEPT};

static struct pattern_flip flip_of(uint64_t vblank)
{
	return (struct pattern_flip){
		.vblank = vblank, .flip_ns = 1000000 + vblank * 8333, .show = shows[vblank % 8], .level = vblank % 3 == 0};
}

/* The levels of the lines right after each of eight flips, as digits; '.' where nothing changes. */
static const char *trace(struct pattern pattern)
{
	static char text[17];
	uint32_t levels = pattern.levels;
	for (uint64_t i = 0; i < 8; i++) {
		const struct pattern_flip flip = flip_of(i);
		struct pattern_change change;
		const bool any = pattern_add_flip(&pattern, &flip, &change);
		if (any) {
			CHECK_INT(change.time_ns, flip.flip_ns + pattern.offset_ns);
			CHECK_INT(change.vblank, i);
			CHECK_INT(change.levels & ~change.mask, 0);
		}
		levels = (levels & ~change.mask) | change.levels;
		text[i] = any ? (char)('0' + levels) : '.';
		if (change.pulse_ns)
			levels &= ~change.mask;
	}
	text[8] = 0;
	return text;
}

static void test_patterns(void)
{
	CHECK_STRING(trace((struct pattern){PATTERN_TOGGLE, 1, 100, 0, 0}), "10101010");
	CHECK_STRING(trace((struct pattern){PATTERN_TOGGLE, 1, 100, 0, 1}), "01010101");
	CHECK_STRING(trace((struct pattern){PATTERN_PULSE, 1, 100, 0, 0}), "11111111");
	CHECK_STRING(trace((struct pattern){PATTERN_PULSE_REAL, 1, 100, 0, 0}), "1..1..1.");
	CHECK_STRING(trace((struct pattern){PATTERN_LEVEL_REAL, 1, 100, 0, 0}), "10.1.01.");
	CHECK_STRING(trace((struct pattern){PATTERN_THREE_LINES, 3, 100, 0, 0}), "35531131");
	CHECK_STRING(trace((struct pattern){PATTERN_COUNTER, 3, 100, 0, 0}), ".1234567");
	CHECK_STRING(trace((struct pattern){PATTERN_SEQUENCE, 1, 100, 0, 0}), "10.10.10");
}

static void test_offset(void)
{
	CHECK_STRING(trace((struct pattern){PATTERN_PULSE, 1, 100, 4200000, 0}), "11111111");
}

static void test_counter_wraps(void)
{
	struct pattern pattern = {.kind = PATTERN_COUNTER, .lines = 8, .levels = 0xff};
	const struct pattern_flip flip = {.vblank = 0x123400, .flip_ns = 5};
	struct pattern_change change;
	CHECK(pattern_add_flip(&pattern, &flip, &change));
	CHECK_INT(change.mask, 0xff);
	CHECK_INT(change.levels, 0);
}

static void test_lines(void)
{
	CHECK_INT(pattern_lines(PATTERN_TOGGLE), 1);
	CHECK_INT(pattern_lines(PATTERN_THREE_LINES), 3);
	CHECK_INT(pattern_lines(PATTERN_COUNTER), 0);
}

static void test_schedule_order(void)
{
	static const uint64_t times[] = {50, 10, 30, 30, 20, 40, 0, 30};
	struct schedule schedule = {0};
	struct pattern_change change;
	uint64_t last = 0, order = 0;
	CHECK(schedule_next(&schedule) == UINT64_MAX);
	for (uint64_t i = 0; i < 8; i++) {
		const struct pattern_change add = {.time_ns = times[i], .vblank = i};
		schedule_add(&schedule, &add);
	}
	CHECK_INT(schedule_next(&schedule), 0);
	CHECK(schedule_take(&schedule, 0, &change));
	CHECK(!schedule_take(&schedule, 9, &change));
	while (schedule_take(&schedule, 100, &change)) {
		CHECK(change.time_ns >= last);
		/* Those of one time stay in order. */
		if (change.time_ns == 30)
			order = order * 10 + change.vblank;
		last = change.time_ns;
	}
	CHECK_INT(order, 237);
	CHECK_INT(last, 50);
}

static void test_schedule_full(void)
{
	struct schedule schedule = {0};
	struct pattern_change change = {0};
	uint32_t taken = 0;
	for (uint64_t i = 0; i < SCHEDULE_CHANGES + 10; i++) {
		change.time_ns = i;
		schedule_add(&schedule, &change);
	}
	CHECK_INT(schedule.dropped, 10);
	while (schedule_take(&schedule, UINT64_MAX, &change))
		taken++;
	CHECK_INT(taken, SCHEDULE_CHANGES);
}

/* A change for which there was no room was not made: those after it begin where the lines are. */
static void test_dropped_change(void)
{
	static const enum pattern_kind kinds[] = {PATTERN_COUNTER, PATTERN_TOGGLE};
	for (size_t k = 0; k < 2; k++) {
		struct pattern pattern = {.kind = kinds[k], .lines = kinds[k] == PATTERN_COUNTER ? 8 : 1};
		struct schedule schedule = {0};
		struct pattern_change change;
		uint32_t levels = 0;
		for (uint64_t i = 1; i < SCHEDULE_CHANGES + 6; i++) {
			const struct pattern_flip flip = flip_of(i);
			CHECK(pattern_add_flip(&pattern, &flip, &change));
			CHECK_INT(pattern_schedule(&pattern, &schedule, &change), i <= SCHEDULE_CHANGES);
		}
		CHECK_INT(schedule.dropped, 5);
		while (schedule_take(&schedule, UINT64_MAX, &change))
			levels = (levels & ~change.mask) | change.levels;
		CHECK_INT(levels, pattern.levels);
		const struct pattern_flip flip = flip_of(0x80);
		CHECK(pattern_add_flip(&pattern, &flip, &change));
		CHECK_INT((levels & ~change.mask) | change.levels, kinds[k] == PATTERN_COUNTER ? 0x80 : levels ^ 1);
	}
}

int main(void)
{
	RUN(test_patterns);
	RUN(test_offset);
	RUN(test_counter_wraps);
	RUN(test_lines);
	RUN(test_schedule_order);
	RUN(test_schedule_full);
	RUN(test_dropped_change);
	return test_result();
}
