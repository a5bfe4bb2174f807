/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Edges to flips, with a fake clock: 120 Hz, a display that shows 3.1 ms after the flip unless a test says otherwise.
 */

#include "daemon/lab/match.h"
#include "tests/test.h"

#define MS INT64_C(1000000)
#define PERIOD UINT64_C(8333333)
#define START UINT64_C(1000000000)
#define HOLD (20 * MS)
#define FLIPS 2000u

/* What happened, by the number of the flip. */
struct outcome {
	uint64_t photon[FLIPS];
	uint32_t fates[4];
	uint64_t next; /* flips come in order */
	bool in_order;
};

static struct outcome outcome;

static void begin(void)
{
	memset(&outcome, 0, sizeof(outcome));
	outcome.in_order = true;
}

static void collect(struct match *match, uint64_t now_ns)
{
	struct match_result result;
	while (match_next(match, now_ns, HOLD, &result)) {
		outcome.fates[result.fate]++;
		if (result.fate == MATCH_STRAY)
			continue;
		outcome.in_order &= result.number == outcome.next++;
		outcome.photon[result.number % FLIPS] = result.edge_ns;
	}
}

static uint64_t flip_time(uint64_t number)
{
	return START + number * PERIOD;
}

static enum match_want alternate(uint64_t number)
{
	return number & 1 ? MATCH_RISING : MATCH_FALLING;
}

static void finish(struct match *match)
{
	collect(match, flip_time(FLIPS) + 1000 * MS);
	CHECK(outcome.in_order);
	CHECK_INT(outcome.next, FLIPS);
	CHECK_INT(match->hits, outcome.fates[MATCH_HIT]);
	CHECK_INT(match->lost, outcome.fates[MATCH_LOST]);
	CHECK_INT(match->stray, outcome.fates[MATCH_STRAY]);
}

static void test_alternate(uint64_t delay_ns)
{
	struct match match = {.most_ns = 2 * PERIOD};
	begin();
	for (uint64_t i = 0; i < FLIPS; i++) {
		match_add_flip(&match, i, flip_time(i), alternate(i));
		match_add_edge(&match, flip_time(i) + delay_ns, i & 1);
		collect(&match, flip_time(i) + delay_ns + 50000);
	}
	finish(&match);
	CHECK_INT(outcome.fates[MATCH_HIT], FLIPS);
	for (uint64_t i = 0; i < FLIPS; i++)
		if (outcome.photon[i] != flip_time(i) + delay_ns)
			CHECK_INT(outcome.photon[i], flip_time(i) + delay_ns);
}

static void test_all_hit(void)
{
	test_alternate(0);
	test_alternate(3 * MS);
	test_alternate(PERIOD - 1);
}

/* The edge comes a refresh and a half after its flip, when the next flip is known already. */
static void test_more_than_a_refresh(void)
{
	const uint64_t delay = PERIOD + PERIOD / 2;
	struct match match = {.most_ns = 2 * PERIOD};
	begin();
	for (uint64_t i = 0; i < FLIPS; i++) {
		match_add_flip(&match, i, flip_time(i), alternate(i));
		if (i > 0)
			match_add_edge(&match, flip_time(i - 1) + delay, (i - 1) & 1);
		collect(&match, flip_time(i) + 5 * MS);
	}
	match_add_edge(&match, flip_time(FLIPS - 1) + delay, (FLIPS - 1) & 1);
	finish(&match);
	CHECK_INT(outcome.fates[MATCH_HIT], FLIPS);
	CHECK_INT(outcome.photon[1234], flip_time(1234) + delay);
}

/* Every 7th edge lost, every 11th twice, every 13th a bounce of 20 us: only those flips suffer. */
static void test_lost_doubled_bounced(void)
{
	struct match match = {.most_ns = PERIOD, .debounce_ns = 100000};
	uint32_t lost = 0, doubled = 0, bounced = 0, wrong = 0;
	begin();
	for (uint64_t i = 0; i < FLIPS; i++) {
		const uint64_t edge = flip_time(i) + 3 * MS;
		match_add_flip(&match, i, flip_time(i), MATCH_RISING);
		if (i % 7 == 3) {
			lost++;
		} else {
			match_add_edge(&match, edge, true);
			if (i % 13 == 1 && ++bounced)
				match_add_edge(&match, edge + 20000, true);
			if (i % 11 == 2 && ++doubled)
				match_add_edge(&match, edge + 2 * MS, true);
		}
		collect(&match, flip_time(i) + 6 * MS);
	}
	finish(&match);
	for (uint64_t i = 0; i < FLIPS; i++)
		wrong += outcome.photon[i] != (i % 7 == 3 ? 0 : flip_time(i) + 3 * MS);
	CHECK_INT(wrong, 0);
	CHECK_INT(outcome.fates[MATCH_LOST], lost);
	CHECK_INT(outcome.fates[MATCH_STRAY], doubled);
	CHECK_INT(match.bounced, bounced);
}

/* An edge that is later than the window is nobody's, not the next flip's. */
static void test_late(void)
{
	struct match match = {.least_ns = 2 * MS, .most_ns = 6 * MS};
	uint32_t wrong = 0;
	begin();
	for (uint64_t i = 0; i < FLIPS; i++) {
		const bool late = i % 5 == 0;
		match_add_flip(&match, i, flip_time(i), MATCH_EITHER);
		match_add_edge(&match, flip_time(i) + (late ? 7 : 3) * MS, true);
		collect(&match, flip_time(i) + 8 * MS);
	}
	finish(&match);
	for (uint64_t i = 0; i < FLIPS; i++)
		wrong += outcome.photon[i] != (i % 5 == 0 ? 0 : flip_time(i) + 3 * MS);
	CHECK_INT(wrong, 0);
	CHECK_INT(outcome.fates[MATCH_STRAY], FLIPS / 5);
	CHECK_INT(outcome.fates[MATCH_LOST], FLIPS / 5);
}

/* The presenter's event comes 12 ms after the flip, long after the edge. */
static void test_event_after_edge(void)
{
	struct match match = {.most_ns = PERIOD};
	uint32_t wrong = 0;
	begin();
	for (uint64_t i = 0; i < FLIPS + 2; i++) {
		if (i < FLIPS)
			match_add_edge(&match, flip_time(i) + 100000, true);
		collect(&match, flip_time(i) + 200000);
		if (i >= 2)
			match_add_flip(&match, i - 2, flip_time(i - 2), MATCH_EITHER);
		collect(&match, flip_time(i) + 300000);
	}
	finish(&match);
	for (uint64_t i = 0; i < FLIPS; i++)
		wrong += outcome.photon[i] != flip_time(i) + 100000;
	CHECK_INT(wrong, 0);
}

static void test_silent_and_direction(void)
{
	struct match match = {.most_ns = PERIOD};
	begin();
	for (uint64_t i = 0; i < FLIPS; i++) {
		match_add_flip(&match, i, flip_time(i), i % 4 == 0 ? MATCH_RISING : MATCH_NONE);
		if (i % 4 < 2)
			match_add_edge(&match, flip_time(i) + MS, i % 4 == 0);
		collect(&match, flip_time(i) + 2 * MS);
	}
	finish(&match);
	CHECK_INT(outcome.fates[MATCH_HIT], FLIPS / 4);
	CHECK_INT(outcome.fates[MATCH_SILENT], FLIPS - FLIPS / 4);
	CHECK_INT(outcome.fates[MATCH_STRAY], FLIPS / 4);
}

/* Nobody collects: nothing breaks, and it is counted. */
static void test_overflow(void)
{
	struct match match = {.most_ns = PERIOD};
	begin();
	for (uint64_t i = 0; i < FLIPS; i++) {
		match_add_flip(&match, i, flip_time(i), MATCH_RISING);
		match_add_edge(&match, flip_time(i) + MS, true);
	}
	CHECK_INT(match.overflowed, 2 * FLIPS - MATCH_FLIPS - MATCH_EDGES);
	outcome.next = FLIPS - MATCH_FLIPS;
	collect(&match, flip_time(FLIPS) + 100 * MS);
	CHECK_INT(outcome.fates[MATCH_HIT], MATCH_FLIPS);
}

int main(void)
{
	RUN(test_all_hit);
	RUN(test_more_than_a_refresh);
	RUN(test_lost_doubled_bounced);
	RUN(test_late);
	RUN(test_event_after_edge);
	RUN(test_silent_and_direction);
	RUN(test_overflow);
	return test_result();
}
