/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/strobe.h"
#include "tests/test.h"

#define PERIOD 8333333.0
#define START UINT64_C(1000000000)

static uint32_t random_state = 7;

static double random_share(void)
{
	random_state = random_state * 1664525u + 1013904223u;
	return (random_state >> 8) / 16777216.0;
}

static void test_steady(void)
{
	struct strobe strobe;
	double on = 0;
	strobe_init(&strobe, 0.5, 0.2, 0.2, PERIOD);
	for (uint64_t i = 0; i < 1000; i++) {
		/* Duty at the limit, and wake-ups that jitter: still none is left out. */
		const uint64_t due = strobe_due(&strobe, START + (uint64_t)((double)i * PERIOD));
		const uint64_t now = due + (uint64_t)(random_share() * 200e3);
		const uint64_t off = strobe_begin(&strobe, due, now);
		CHECK(off > now);
		on += (double)(off - now);
		strobe_end(&strobe, off);
	}
	CHECK_INT(strobe.pulses, 1000);
	CHECK_INT(strobe.left_out, 0);
	CHECK_INT(strobe.too_long, 0);
	CHECK_NEAR(on / (1000 * PERIOD), 0.2, 0.0001);
	CHECK_INT(strobe_due(&strobe, START), START + 4166667);
}

/* Whatever the flips and the wake-ups do, the light in any stretch of time stays below the limit. */
static void test_hard_limit(void)
{
	static double starts[20000], ends[20000];
	struct strobe strobe;
	uint32_t count = 0, broken = 0;
	double flip = (double)START, now = 0;
	strobe_init(&strobe, 0.0, 0.25, 0.25, PERIOD);
	for (uint32_t i = 0; i < 20000; i++) {
		flip += random_share() < 0.3 ? random_share() * 1e6 : PERIOD * (0.5 + random_share());
		now = fmax(now, flip + random_share() * 1e6);
		const uint64_t off = strobe_begin(&strobe, (uint64_t)flip, (uint64_t)now);
		if (!off)
			continue;
		starts[count] = now;
		now = (double)off;
		ends[count++] = now;
		strobe_end(&strobe, off);
	}
	CHECK(count > 5000 && strobe.left_out > 1000);
	for (uint32_t first = 0; first < count; first += 37) {
		double on = 0;
		for (uint32_t i = first; i < count && i < first + 300; i++) {
			on += ends[i] - starts[i];
			broken += on > 0.25 * (ends[i] - starts[first] + 1.25 * PERIOD) + 1000;
		}
	}
	CHECK_INT(broken, 0);
}

/* A thread that was held up switches off late: the next pulses pay for it. */
static void test_overlong(void)
{
	struct strobe strobe;
	uint32_t left_out = 0;
	strobe_init(&strobe, 0.0, 0.1, 0.2, PERIOD);
	CHECK(strobe_begin(&strobe, START, START) != 0);
	strobe_end(&strobe, START + (uint64_t)PERIOD);
	CHECK_INT(strobe.too_long, 1);
	for (uint64_t i = 1; i < 20; i++) {
		const uint64_t due = START + (uint64_t)((double)i * PERIOD);
		const uint64_t off = strobe_begin(&strobe, due, due);
		left_out += off == 0;
		strobe_end(&strobe, off);
	}
	/* A whole period is missing from a bucket of 0.25: 0.85 to win back, 0.2 a period. */
	CHECK_INT(left_out, 5);
}

static void test_late_and_double(void)
{
	struct strobe strobe;
	strobe_init(&strobe, 0.0, 0.1, 0.2, PERIOD);
	CHECK(strobe_begin(&strobe, START, START + 2100000) == 0);
	CHECK(strobe_begin(&strobe, START, START + 2000000) != 0);
	CHECK(strobe_begin(&strobe, START, START + 2000001) == 0);
	CHECK_INT(strobe.left_out, 2);
	strobe_end(&strobe, START + 2500000);
	strobe_end(&strobe, START + 9500000);
	CHECK_INT(strobe.too_long, 0);
}

static void test_absurd_settings(void)
{
	struct strobe strobe;
	strobe_init(&strobe, -1.0, 0.9, 7.0, PERIOD);
	CHECK_NEAR(strobe.limit, STROBE_MOST, 0);
	CHECK_NEAR(strobe.duty, STROBE_MOST, 0);
	CHECK_NEAR(strobe.phase, 0, 0);
	strobe_init(&strobe, NAN, NAN, NAN, PERIOD);
	CHECK_NEAR(strobe.duty, 0, 0);
	CHECK(strobe_begin(&strobe, START, START) == 0);
}

int main(void)
{
	RUN(test_steady);
	RUN(test_hard_limit);
	RUN(test_overlong);
	RUN(test_late_and_double);
	RUN(test_absurd_settings);
	return test_result();
}
