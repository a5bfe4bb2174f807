/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A display's period and phase from simulated stamps. */

#include "daemon/present/vblanks.h"
#include "tests/pacing/random.h"
#include "tests/test.h"

#define START UINT64_C(1000000000)

/* A display: its true vblanks, and the stamps that it gives. */
struct display {
	double period_ns, drift_ns; /* at first; and what each vblank adds */
	double noise_ns, tail_ns;   /* of stamps: normal; late with a heavy tail */
	double miss;                /* share of vblanks without a stamp */
	bool counts;                /* stamps have sequences */
	double time_ns;             /* of the next vblank after START */
	uint64_t sequence;
	struct random random;
	struct vblanks vblanks;

	uint64_t true_vblanks, first_number, last_number; /* since watch() */
	double worst_ns, sum_ns;                          /* distance of the next vblank's time from the truth */
	uint64_t worst_slip;                              /* of numbers against true vblanks */
	uint64_t jumps_back, given;
};

static void begin(struct display *d, uint64_t numerator, uint64_t denominator)
{
	d->random.state = 7;
	d->time_ns = 3000000.0;
	if (d->sequence == 0)
		d->sequence = 100;
	vblanks_init(&d->vblanks, numerator, denominator, START);
}

/* Forgets what was seen so far. */
static void watch(struct display *d)
{
	d->worst_ns = d->sum_ns = 0.0;
	d->worst_slip = d->given = d->true_vblanks = d->jumps_back = 0;
	d->first_number = d->last_number = 0;
}

static void judge(struct display *d, uint64_t number)
{
	const struct grid grid = vblanks_get_grid(&d->vblanks);
	const double next_ns = (double)START + d->time_ns; /* has moved on already */
	const double off = fabs((double)grid_time(&grid, number + 1) - next_ns);
	if (d->given++ == 0) {
		d->first_number = number;
		d->true_vblanks = 0;
	}
	const uint64_t slip = number - d->first_number - d->true_vblanks;
	d->worst_slip = (int64_t)slip < 0 ? (uint64_t)1 << 40 : slip > d->worst_slip ? slip : d->worst_slip;
	d->jumps_back += number < d->last_number;
	d->last_number = number;
	d->worst_ns = fmax(d->worst_ns, off);
	d->sum_ns += off;
}

static void run(struct display *d, uint64_t vblanks)
{
	for (uint64_t i = 0; i < vblanks; i++) {
		const double late = d->noise_ns * random_normal(&d->random) + d->tail_ns * random_tail(&d->random, 20.0);
		const bool missed = random_unit(&d->random) < d->miss;
		const uint64_t stamp = START + (uint64_t)(d->time_ns + late);
		const uint64_t sequence = d->counts ? d->sequence : 0;
		d->time_ns += d->period_ns;
		d->period_ns += d->drift_ns;
		d->sequence++;
		if (!missed)
			judge(d, vblanks_add(&d->vblanks, sequence, stamp));
		d->true_vblanks++;
	}
}

static void test_before_any_stamp(void)
{
	struct vblanks v;
	vblanks_init(&v, 120000, 1001, 5000);
	struct grid grid = vblanks_get_grid(&v);
	CHECK_INT(grid.numerator, 120000);
	CHECK_INT(grid.denominator, 1001);
	CHECK_INT(grid_time(&grid, 0), 5000);
	CHECK(!vblanks_known(&v));
	vblanks_init(&v, 0, 0, 5000);
	grid = vblanks_get_grid(&v);
	CHECK_INT(grid_time(&grid, 120), 1000005000);
}

/* Grids with an epoch in the middle are exact on both sides. */
static void test_grid_around_its_epoch(void)
{
	const struct grid grid = {
		.numerator = 1439, .denominator = 10, .epoch_ns = UINT64_C(7000000000007), .epoch_vblank = 100000};
	for (uint64_t k = 0; k < 200000; k += 13) {
		const uint64_t t = grid_time(&grid, k);
		const long double exact = (long double)grid.epoch_ns + ((long double)k - 100000.0L) * 1e10L / 1439.0L;
		CHECK(exact - (long double)t > -1e-3L && exact - (long double)t < 1.001L);
		CHECK_INT(grid_at_or_after(&grid, t), k);
		CHECK_INT(grid_at_or_after(&grid, t + 1), k + 1);
		CHECK_INT(grid_at_or_after(&grid, t - 1), k);
	}
	const struct grid early = {.numerator = 1, .denominator = 1, .epoch_ns = 5, .epoch_vblank = 10};
	CHECK_INT(grid_time(&early, 0), 0);
	CHECK_INT(grid_at_or_after(&early, 0), 10);
}

/* Wished for 120, it runs at something near: the true rate is found, and nothing is missed or doubled. */
static void test_rates_near_the_wished_one(void)
{
	static const double rates[] = {120, 120000.0 / 1001, 119.5, 121, 118};
	for (size_t i = 0; i < sizeof(rates) / sizeof(rates[0]); i++) {
		for (int noisy = 0; noisy < 2; noisy++) {
			struct display d = {.period_ns = 1e9 / rates[i], .noise_ns = noisy ? 100000 : 100};
			begin(&d, 120, 1);
			run(&d, 1200);
			watch(&d);
			run(&d, 3000);
			CHECK_NEAR(1e9 / d.vblanks.period_ns, rates[i], noisy ? 0.02 : 0.0001);
			CHECK_NEAR(d.worst_ns, 0, noisy ? 60000 : 150);
			CHECK_INT(d.worst_slip, 0);
			CHECK_INT(d.jumps_back, 0);
			CHECK_INT(d.vblanks.missed, 0);
			CHECK(vblanks_known(&d.vblanks));
		}
	}
}

/* A mode that nobody spoke of: stamps show it, with sequences at once, without as soon as that is certain. */
static void test_rates_far_from_the_wished_one(void)
{
	static const double rates[] = {24, 30, 50, 60, 75, 90, 100, 144, 165, 240, 360, 500};
	for (size_t i = 0; i < sizeof(rates) / sizeof(rates[0]); i++) {
		for (int counts = 0; counts < 2; counts++) {
			struct display d = {.period_ns = 1e9 / rates[i], .noise_ns = 20000, .counts = counts};
			begin(&d, 120, 1);
			run(&d, 300);
			watch(&d);
			run(&d, 1000);
			CHECK_NEAR(1e9 / d.vblanks.period_ns, rates[i], 0.0005 * rates[i]);
			CHECK_NEAR(d.worst_ns, 0, 30000);
			CHECK_INT(d.worst_slip, 0);
			CHECK_INT(d.jumps_back, 0);
		}
	}
}

static void test_missed_vblanks_are_counted(void)
{
	for (int counts = 0; counts < 2; counts++) {
		struct display d = {
			.period_ns = 1e9 / 119.88, .noise_ns = 150000, .tail_ns = 100000, .miss = 0.2, .counts = counts};
		begin(&d, 120, 1);
		run(&d, 600);
		watch(&d);
		const uint64_t before = d.vblanks.missed;
		run(&d, 10000);
		CHECK_INT(d.worst_slip, 0);
		CHECK_NEAR((double)(d.vblanks.missed - before), 10000 - (double)d.given, 1);
		CHECK(d.worst_ns < 250000);
	}
}

/* Stamps taken by a thread that is scheduled now and then: the line lies where most stamps lie. */
static void test_heavy_tails_are_rejected(void)
{
	struct display d = {.period_ns = 1e9 / 120, .noise_ns = 20000, .tail_ns = 50000};
	begin(&d, 120, 1);
	run(&d, 1000);
	watch(&d);
	run(&d, 20000);
	CHECK_NEAR(d.vblanks.period_ns, 1e9 / 120, 1000);
	CHECK(d.worst_ns < 120000);
	CHECK_INT(d.worst_slip, 0);
	CHECK(d.vblanks.outliers > 100);
	CHECK_INT(d.vblanks.steps, 0);
}

static void test_drift_is_followed(void)
{
	/* 120 Hz becomes 119.4 Hz within 84 s: 5000 ppm, more than any crystal */
	struct display d = {.period_ns = 1e9 / 120, .drift_ns = 4.166667, .noise_ns = 5000};
	begin(&d, 120, 1);
	run(&d, 300);
	watch(&d);
	run(&d, 10000);
	CHECK_INT(d.worst_slip, 0);
	CHECK(d.worst_ns < 100000);
	CHECK_NEAR(d.vblanks.period_ns, d.period_ns, 1500);
}

/* A mode change while it runs: numbers go on, and soon the times are right again. */
static void test_period_steps(void)
{
	static const double rates[] = {60, 120, 144, 119.88, 120, 48, 240, 100, 120};
	for (int counts = 0; counts < 2; counts++) {
		struct display d = {.period_ns = 1e9 / 120, .noise_ns = 10000, .counts = counts};
		begin(&d, 120, 1);
		run(&d, 500);
		for (size_t i = 0; i < sizeof(rates) / sizeof(rates[0]); i++) {
			const uint64_t before = d.last_number;
			d.period_ns = 1e9 / rates[i];
			watch(&d);
			run(&d, 200);
			CHECK_INT(d.jumps_back, 0);
			CHECK(d.last_number > before && d.last_number < before + 300);
			watch(&d);
			run(&d, 300);
			CHECK_INT(d.worst_slip, 0);
			CHECK_NEAR(d.worst_ns, 0, 20000);
		}
	}
}

/* Sleep for 10 s: vblanks went by, whether the display counted them or not. */
static void test_suspend(void)
{
	for (int counts = 0; counts < 3; counts++) {
		struct display d = {.period_ns = 1e9 / 119.88, .noise_ns = 10000, .counts = counts > 0};
		begin(&d, 120, 1);
		run(&d, 1000);
		const uint64_t before = d.last_number;
		d.time_ns += 10e9;
		d.sequence += counts == 2 ? 1199 : 0;
		watch(&d);
		run(&d, 100);
		CHECK_NEAR((double)(d.first_number - before), 1199.8, 1.5);
		CHECK_INT(d.worst_slip, 0);
		CHECK_INT(d.jumps_back, 0);
		CHECK_NEAR(d.worst_ns, 0, 40000);
		CHECK_NEAR(d.vblanks.period_ns, 1e9 / 119.88, 2000);
	}
}

/* The phase jumps and the period stays, as after a virtual terminal came back. */
static void test_phase_step(void)
{
	struct display d = {.period_ns = 1e9 / 120, .noise_ns = 10000};
	begin(&d, 120, 1);
	run(&d, 500);
	d.time_ns += 3e6;
	watch(&d);
	run(&d, 60);
	CHECK_INT(d.jumps_back, 0);
	watch(&d);
	run(&d, 500);
	CHECK_NEAR(d.worst_ns, 0, 20000);
	CHECK_INT(d.worst_slip, 0);
}

static void test_sequence_wraps_and_resets(void)
{
	struct display d = {.period_ns = 1e9 / 120, .noise_ns = 10000, .counts = true, .miss = 0.1};
	d.sequence = UINT32_MAX - 50;
	begin(&d, 120, 1);
	run(&d, 20);
	watch(&d);
	for (int i = 0; i < 100; i++) {
		d.sequence &= UINT32_MAX;
		run(&d, 1);
	}
	CHECK_INT(d.worst_slip, 0);
	d.sequence = 5;
	run(&d, 300);
	d.sequence = 40000000;
	run(&d, 300);
	CHECK_INT(d.worst_slip, 0);
	CHECK_INT(d.jumps_back, 0);
	CHECK_INT(d.vblanks.steps, 0);
}

/* Any stamp whatever gives a finite grid, and sense comes back. */
static void test_nonsense(void)
{
	struct display d = {.period_ns = 1e9 / 120, .noise_ns = 10000};
	static const uint64_t times[] = {0, 1, UINT64_MAX, INT64_MAX, (uint64_t)INT64_MAX + 1, START, START + 1};
	struct random random = {3};
	begin(&d, 120, 1);
	run(&d, 100);
	for (int i = 0; i < 5000; i++) {
		const uint64_t number = d.vblanks.number;
		const uint64_t a = random_bits(&random), b = random_bits(&random);
		const uint64_t got = vblanks_add(&d.vblanks, a % 3 ? 0 : b, a % 5 ? times[b % 7] : b >> (a % 64));
		const struct grid grid = vblanks_get_grid(&d.vblanks);
		CHECK(got >= number);
		CHECK(grid.denominator >= UINT64_C(500000) * 1000000 && grid.denominator <= UINT64_C(2000000000) * 1000000);
		CHECK(isfinite(d.vblanks.rest_ns) && isfinite(d.vblanks.spread_ns));
	}
	d.last_number = 0;
	run(&d, 200);
	watch(&d);
	run(&d, 500);
	CHECK_INT(d.jumps_back, 0);
	CHECK_NEAR(d.worst_ns, 0, 20000);
}

int main(void)
{
	RUN(test_before_any_stamp);
	RUN(test_grid_around_its_epoch);
	RUN(test_rates_near_the_wished_one);
	RUN(test_rates_far_from_the_wished_one);
	RUN(test_missed_vblanks_are_counted);
	RUN(test_heavy_tails_are_rejected);
	RUN(test_drift_is_followed);
	RUN(test_period_steps);
	RUN(test_suspend);
	RUN(test_phase_step);
	RUN(test_sequence_wraps_and_resets);
	RUN(test_nonsense);
	return test_result();
}
