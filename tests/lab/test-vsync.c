/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The external vsync, with a fake clock: what a wire may carry, and what is believed of it. */

#include "daemon/present/vsync.h"
#include "tests/test.h"

#define US 1e3
#define MS UINT64_C(1000000)
#define PERIOD 8333333.0
#define START 5e9
#define SEED UINT64_C(88172645463325252)

/* A wire: vblanks of its own period, and what happens to the edges of each. Shares in thousandths. */
struct wire {
	double period, jitter; /* of stamps, late by up to so much */
	uint32_t lost, doubled, noise, late, bouncing;
};

static uint64_t state = SEED;
static char sentence[VSYNC_SENTENCE];
static double now; /* of the wire's next vblank */

static double chance(void)
{
	state ^= state << 13;
	state ^= state >> 7;
	state ^= state << 17;
	return (double)(state >> 11) / 9007199254740992.0;
}

static bool happens(uint32_t thousandths)
{
	return chance() * 1000.0 < thousandths;
}

static void play(struct vsync *vsync, const struct wire *wire, uint32_t vblanks)
{
	for (uint32_t i = 0; i < vblanks; i++, now += wire->period) {
		const double at = now + chance() * wire->jitter + (happens(wire->late) ? 1e6 * chance() : 0.0);
		if (!happens(wire->lost))
			vsync_add_edge(vsync, (uint64_t)at);
		for (int bounce = 1; bounce <= 3 && happens(wire->bouncing); bounce++)
			vsync_add_edge(vsync, (uint64_t)(at + bounce * 150 * US));
		if (happens(wire->doubled))
			vsync_add_edge(vsync, (uint64_t)(at + 0.55 * wire->period));
		if (happens(wire->noise))
			vsync_add_edge(vsync, (uint64_t)(at + (0.15 + 0.8 * chance()) * wire->period));
	}
}

static struct vsync *begin(void)
{
	now = START;
	return vsync_create(PERIOD, 0.0);
}

static enum vsync_state state_of(struct vsync *vsync)
{
	return vsync_get_counts(vsync).state;
}

/* How far the grid's vblanks are from the wire's own, at the wire's time now. */
static double phase_error(struct vsync *vsync, double period)
{
	struct grid grid;
	CHECK(vsync_get_grid(vsync, (uint64_t)now, &grid) != 0);
	const double vblanks = ((double)grid.epoch_ns - START) / period;
	CHECK_NEAR(grid_period_ns(&grid), period, 0.0005 * period);
	return fabs(vblanks - round(vblanks)) * period;
}

static void test_clean(void)
{
	const struct wire wire = {.period = 8341675.0, .jitter = 5 * US}; /* 119.88 Hz */
	struct vsync *vsync = begin();
	struct grid grid;
	CHECK(!vsync_check(vsync, (uint64_t)now, sentence));
	play(vsync, &wire, 60);
	CHECK(vsync_get_grid(vsync, (uint64_t)now, &grid) == 0);
	play(vsync, &wire, 8);
	CHECK(vsync_check(vsync, (uint64_t)now, sentence));
	CHECK(strstr(sentence, "vblanks follow it, 119.8"));
	CHECK(!vsync_check(vsync, (uint64_t)now, sentence));
	play(vsync, &wire, 2000);
	CHECK_NEAR(phase_error(vsync, wire.period), 2.5 * US, 4 * US);
	CHECK_INT(vsync_get_counts(vsync).trusted, 1);
	vsync_destroy(&vsync);
	CHECK(vsync == NULL);
}

static void test_offset(void)
{
	const struct wire wire = {.period = PERIOD};
	struct grid plain = {0}, moved = {0};
	struct vsync *vsync = begin();
	play(vsync, &wire, 300);
	CHECK(vsync_get_grid(vsync, (uint64_t)now, &plain) != 0);
	vsync_destroy(&vsync);
	now = START;
	vsync = vsync_create(PERIOD, -2.5e6);
	play(vsync, &wire, 300);
	CHECK(vsync_get_grid(vsync, (uint64_t)now, &moved) != 0);
	CHECK_NEAR((double)plain.epoch_ns - (double)moved.epoch_ns, 2.5e6, 1);
	vsync_destroy(&vsync);
}

/* What a wire may do now and then. */
static void test_tolerated(void)
{
	static const struct wire wires[] = {
		{.period = PERIOD, .jitter = 20 * US, .lost = 20},
		{.period = PERIOD, .jitter = 20 * US, .doubled = 20},
		{.period = PERIOD, .jitter = 20 * US, .noise = 20},
		{.period = PERIOD, .jitter = 20 * US, .late = 30},
		{.period = PERIOD, .jitter = 20 * US, .bouncing = 800},
		{.period = PERIOD * 1.01,
		 .jitter = 50 * US,
		 .lost = 10,
		 .doubled = 10,
		 .noise = 10,
		 .late = 10,
		 .bouncing = 200},
	};
	for (size_t i = 0; i < sizeof(wires) / sizeof(wires[0]); i++) {
		struct vsync *vsync = begin();
		play(vsync, &wires[i], 600);
		CHECK_INT(state_of(vsync), VSYNC_TRUSTED);
		for (int j = 0; j < 100; j++) {
			play(vsync, &wires[i], 100);
			CHECK_NEAR(phase_error(vsync, wires[i].period), 0, 60 * US);
		}
		CHECK_INT(state_of(vsync), VSYNC_TRUSTED);
		CHECK(vsync_get_counts(vsync).trusted == 1);
		CHECK((wires[i].lost > 0) == (vsync_get_counts(vsync).missed > 50));
		CHECK((wires[i].doubled + wires[i].noise > 0) == (vsync_get_counts(vsync).extra > 50));
		CHECK(wires[i].bouncing == 0 || vsync_get_counts(vsync).bounced > 1000);
		vsync_destroy(&vsync);
	}
}

static void check_refused(const struct wire *wire, const char *words)
{
	struct vsync *vsync = begin();
	bool said = false;
	for (int i = 0; i < 200; i++) {
		play(vsync, wire, 20);
		said |= vsync_check(vsync, (uint64_t)now, sentence);
		CHECK(state_of(vsync) != VSYNC_TRUSTED);
	}
	CHECK(said && state_of(vsync) == VSYNC_REFUSED);
	if (!strstr(sentence, words))
		printf("  %s\n", sentence);
	CHECK(strstr(sentence, words));
	vsync_destroy(&vsync);
}

static void test_implausible(void)
{
	check_refused(&(struct wire){.period = PERIOD, .lost = 400}, "had no edge");
	check_refused(&(struct wire){.period = PERIOD, .doubled = 1000}, "too many");
	check_refused(&(struct wire){.period = PERIOD, .noise = 500}, "too many");
	check_refused(&(struct wire){.period = PERIOD, .jitter = 0.3 * PERIOD}, "jitter");
	check_refused(&(struct wire){.period = 1e7}, "its rate is 100.00 Hz, the display's is 120.00 Hz");
	check_refused(&(struct wire){.period = PERIOD * 1.035}, "its rate is 115.9");
	check_refused(&(struct wire){.period = PERIOD * 2}, "");
	check_refused(&(struct wire){.period = PERIOD / 2}, "");
	check_refused(&(struct wire){.period = PERIOD / 40}, "");
}

/* Trusted, then bad for a while, then good: believed, not believed, believed again as another one. */
static void check_recovery(const struct wire *bad, uint32_t vblanks, const char *words)
{
	const struct wire good = {.period = PERIOD, .jitter = 10 * US};
	struct vsync *vsync = begin();
	struct grid grid;
	play(vsync, &good, 300);
	const uint64_t trust = vsync_get_grid(vsync, (uint64_t)now, &grid);
	CHECK(trust != 0 && vsync_check(vsync, (uint64_t)now, sentence));
	play(vsync, bad, vblanks);
	CHECK(vsync_get_grid(vsync, (uint64_t)now, &grid) == 0);
	CHECK(vsync_check(vsync, (uint64_t)now, sentence));
	if (!strstr(sentence, words))
		printf("  %s\n", sentence);
	CHECK(strstr(sentence, words) && strstr(sentence, "not used until"));
	play(vsync, &good, 500);
	CHECK(vsync_check(vsync, (uint64_t)now, sentence));
	const uint64_t again = vsync_get_grid(vsync, (uint64_t)now, &grid);
	CHECK(again != 0 && again != trust);
	vsync_destroy(&vsync);
}

static void test_recovery(void)
{
	check_recovery(&(struct wire){.period = PERIOD, .lost = 1000}, 9, "no edge comes");
	check_recovery(&(struct wire){.period = PERIOD, .lost = 1000}, 9000, "no edge comes");
	check_recovery(&(struct wire){.period = PERIOD, .lost = 600}, 100, "had no edge");
	check_recovery(&(struct wire){.period = PERIOD, .doubled = 1000}, 100, "too many");
	check_recovery(&(struct wire){.period = PERIOD * 1.25}, 100, "");
}

/* A new mode: the same rate with another phase is another vsync. */
static void test_jump(void)
{
	const struct wire wire = {.period = PERIOD, .jitter = 10 * US};
	struct vsync *vsync = begin();
	play(vsync, &wire, 300);
	now += 0.4 * PERIOD;
	play(vsync, &wire, 30);
	CHECK_INT(state_of(vsync), VSYNC_REFUSED);
	play(vsync, &wire, 100);
	CHECK_INT(vsync_get_counts(vsync).trusted, 2);
	vsync_destroy(&vsync);
}

/* A display whose rate drifts is followed. */
static void test_drift(void)
{
	struct vsync *vsync = begin();
	struct wire wire = {.period = PERIOD, .jitter = 5 * US};
	double worst = 0.0;
	play(vsync, &wire, 400);
	for (int i = 0; i < 4000; i++) {
		struct grid grid;
		wire.period += 0.02; /* 0.001 in all */
		play(vsync, &wire, 1);
		CHECK(vsync_get_grid(vsync, (uint64_t)now, &grid) != 0);
		const double vblanks = (now - (double)grid.epoch_ns) / wire.period;
		worst = fmax(worst, fabs(vblanks - round(vblanks)) * wire.period);
	}
	CHECK(worst < 0.05 * MS);
	vsync_destroy(&vsync);
}

static void test_silence_from_the_start(void)
{
	struct vsync *vsync = begin();
	CHECK(!vsync_check(vsync, 1000 * MS, sentence));
	const uint64_t next = vsync_next(vsync);
	CHECK_INT(next, 3000 * MS);
	CHECK(vsync_check(vsync, next, sentence));
	CHECK(strstr(sentence, "no edge comes"));
	CHECK(vsync_next(vsync) == UINT64_MAX);
	CHECK(!vsync_check(vsync, 60000 * MS, sentence));
	now = 70e9;
	play(vsync, &(struct wire){.period = PERIOD}, 100);
	CHECK(vsync_check(vsync, (uint64_t)now, sentence));
	CHECK_INT(state_of(vsync), VSYNC_TRUSTED);
	vsync_destroy(&vsync);
}

static void test_nonsense(void)
{
	static const uint64_t times[] = {0, UINT64_MAX, 5, UINT64_MAX - 1, UINT64_MAX / 2, 1, 1, 0};
	struct vsync *vsync = begin(), *none = NULL;
	struct grid grid;
	for (size_t i = 0; i < 10 * sizeof(times) / sizeof(times[0]); i++) {
		vsync_add_edge(vsync, times[i % (sizeof(times) / sizeof(times[0]))]);
		vsync_check(vsync, times[i % 3], sentence);
	}
	CHECK(vsync_get_grid(vsync, UINT64_MAX, &grid) == 0);
	vsync_check(vsync, UINT64_MAX, sentence);
	play(vsync, &(struct wire){.period = PERIOD}, 400);
	vsync_destroy(&vsync);
	vsync_destroy(&none);
	CHECK(vsync_get_grid(NULL, 1, &grid) == 0);
	vsync_expect(NULL, 1.0);
}

/* Returns of swaps, late by up to 3 ms, are dated back to the wire's vblanks. */
static void check_dating(double display_period, uint32_t least, uint32_t most)
{
	const struct wire wire = {.period = PERIOD, .jitter = 10 * US};
	struct vsync *vsync = begin();
	struct vblanks returns;
	uint32_t dated = 0, wrong = 0;
	uint64_t last = 0;
	vblanks_init(&returns, 120, 1, 0);
	play(vsync, &wire, 400);
	for (uint32_t i = 0; i < 1000; i++, play(vsync, &wire, 1)) {
		const double vblank = START + (400 + i) * display_period;
		uint64_t time_ns = (uint64_t)(vblank + 3e6 * chance()), sequence = 0;
		vblanks_add(&returns, 0, time_ns);
		if (!vsync_date_back(vsync, &returns, &time_ns, &sequence))
			continue;
		dated++;
		wrong += fabs((double)time_ns - vblank) > 60 * US || (last && sequence != last + 1);
		last = sequence;
	}
	CHECK(dated >= least && dated <= most);
	CHECK(display_period != PERIOD || wrong == 0);
	vsync_destroy(&vsync);
}

static void test_dating(void)
{
	check_dating(PERIOD, 990, 1000);
	/* Another display's wire: 119.88 and 120 Hz. */
	check_dating(8341675.0, 0, 400);
}

/* Stamps of the time of day, as kernels before 5.7 have them, tell nothing about vblanks; one alone is got over. */
static void test_another_clock(void)
{
	const struct wire wire = {.period = PERIOD};
	struct vsync *vsync = begin();
	struct grid grid;
	now = 1.7e18;
	play(vsync, &wire, 100);
	CHECK(vsync_get_grid(vsync, (uint64_t)START, &grid) == 0);
	CHECK(vsync_check(vsync, (uint64_t)START, sentence));
	CHECK(strstr(sentence, "its edges bear times of another clock"));
	play(vsync, &wire, 10);
	CHECK(!vsync_check(vsync, (uint64_t)START, sentence));
	now = START;
	play(vsync, &wire, 200);
	CHECK_INT(state_of(vsync), VSYNC_TRUSTED);
	vsync_add_edge(vsync, (uint64_t)(now + 1e6 * PERIOD));
	CHECK(vsync_get_grid(vsync, (uint64_t)now, &grid) == 0);
	vsync_check(vsync, (uint64_t)now, sentence);
	play(vsync, &wire, 100);
	CHECK_INT(state_of(vsync), VSYNC_TRUSTED);
	vsync_destroy(&vsync);
}

static void test_other_rate(void)
{
	struct vsync *vsync = begin();
	play(vsync, &(struct wire){.period = PERIOD}, 200);
	vsync_expect(vsync, PERIOD * 1.001);
	CHECK_INT(state_of(vsync), VSYNC_TRUSTED);
	vsync_expect(vsync, 16666666.0);
	CHECK_INT(state_of(vsync), VSYNC_LEARNING);
	play(vsync, &(struct wire){.period = 16683350.0}, 100);
	CHECK_INT(state_of(vsync), VSYNC_TRUSTED);
	vsync_destroy(&vsync);
}

int main(void)
{
	RUN(test_clean);
	RUN(test_offset);
	RUN(test_tolerated);
	RUN(test_implausible);
	RUN(test_recovery);
	RUN(test_jump);
	RUN(test_drift);
	RUN(test_silence_from_the_start);
	RUN(test_nonsense);
	RUN(test_dating);
	RUN(test_another_clock);
	RUN(test_other_rate);
	return test_result();
}
