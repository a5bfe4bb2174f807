/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The pacer with fake times: grids, rates, jitter, pauses and nonsense. */

#include <stdint.h>

#include "daemon/present/pacer.h"
#include "tests/test.h"

/* A client, a display and what came out. */
struct simulation {
	uint64_t refresh[2];
	double fps;
	double intake_jitter_ms; /* each frame arrives up to so much later than 5 ms */
	double time_jitter_ms;   /* noise of the client's own times */
	uint64_t vblanks;
	bool declare; /* the client says its interval */

	uint64_t frames, real, in_between, repeat, wrong_n;
	double least_phase, most_phase; /* first showings, second half only */
	double worst_step;              /* of the displayed moment between vblanks, relative to even, second half */
	double worst_moment;            /* |displayed moment - steady|, in vblanks, second half */
	struct pacer pacer;
};

static uint32_t random_state = 1;

static double random_unit(void)
{
	random_state = random_state * 1664525u + 1013904223u;
	return (double)(random_state >> 8) / 16777216.0;
}

static uint64_t frame_time(const struct simulation *s, uint64_t index)
{
	return 1000000000u + (uint64_t)((double)index * 1e9 / s->fps);
}

static double period_ms(const struct simulation *s)
{
	return 1000.0 * (double)s->refresh[1] / (double)s->refresh[0];
}

static void count(struct simulation *s, const struct pacer_decision *d, uint64_t vblank, double *before)
{
	const bool settled = vblank > s->vblanks / 2;
	const double moment =
		(double)(int64_t)(s->pacer.frame.time_ns - 1000000000u) / 1e6 + d->phase * (double)d->interval_ns / 1e6;
	s->real += d->show == PACER_REAL;
	s->in_between += d->show == PACER_IN_BETWEEN;
	s->repeat += d->show == PACER_REPEAT;
	if (settled && d->show == PACER_REAL) {
		s->least_phase = fmin(s->least_phase, d->phase);
		s->most_phase = fmax(s->most_phase, d->phase);
	}
	if (settled && d->show != PACER_REPEAT)
		s->worst_step = fmax(s->worst_step, fabs(moment - *before - period_ms(s)) / period_ms(s));
	*before = moment;
}

static void simulate(struct simulation *s)
{
	const struct pacer_params params = {
		.grid = {.numerator = s->refresh[0], .denominator = s->refresh[1], .epoch_ns = 1000000000u + 3000000u}};
	uint64_t next = 0, first = 0, last_n = 0;
	double arrival = 5.0, before = 0;
	pacer_init(&s->pacer, &params);
	for (uint64_t vblank = 0; vblank < s->vblanks; vblank++) {
		const uint64_t deadline = pacer_vblank_time(&s->pacer, vblank) - 2000000u;
		while (frame_time(s, next) + (uint64_t)(arrival * 1e6) <= deadline) {
			struct pacer_frame frame = {.frame_id = next + 1, .time_ns = frame_time(s, next)};
			frame.intake_ns = frame.time_ns + (uint64_t)(arrival * 1e6);
			frame.time_ns += (uint64_t)(random_unit() * s->time_jitter_ms * 1e6);
			frame.interval_ns = s->declare ? (uint64_t)(1e9 / s->fps) : 0;
			pacer_add_frame(&s->pacer, &frame);
			arrival = 5.0 + random_unit() * s->intake_jitter_ms;
			next++;
		}
		const struct pacer_decision d = pacer_decide(&s->pacer, vblank);
		if (d.show == PACER_REAL) {
			s->wrong_n += vblank > 200 && vblank - first != last_n;
			first = vblank;
			last_n = d.n;
		}
		count(s, &d, vblank, &before);
	}
	s->frames = next;
}

static void test_grid(void)
{
	static const uint64_t rates[][2] = {{120, 1}, {120000, 1001}, {1439, 10}, {1, 1}, {1000, 1}, {60000, 1001}};
	for (size_t i = 0; i < sizeof(rates) / sizeof(rates[0]); i++) {
		struct pacer pacer;
		const struct pacer_params params = {
			.grid = {.numerator = rates[i][0], .denominator = rates[i][1], .epoch_ns = UINT64_C(5000000000000)}};
		pacer_init(&pacer, &params);
		CHECK_INT(pacer_vblank_time(&pacer, 0), params.grid.epoch_ns);
		CHECK_INT(pacer_vblank_at_or_after(&pacer, 0), 0);
		CHECK_INT(pacer_vblank_at_or_after(&pacer, params.grid.epoch_ns), 0);
		for (uint64_t k = 1; k < UINT64_C(1) << 33; k = k * 3 + 1) {
			const uint64_t t = pacer_vblank_time(&pacer, k);
			const long double exact = (long double)k * 1e9L * (long double)rates[i][1] / (long double)rates[i][0];
			const long double off = exact - (long double)(t - params.grid.epoch_ns);
			if (k < UINT64_C(1) << 30)
				CHECK(off > -1e-3L && off < 1.001L);
			CHECK_INT(pacer_vblank_at_or_after(&pacer, t), k);
			CHECK_INT(pacer_vblank_at_or_after(&pacer, t + 1), k + 1);
			CHECK_INT(pacer_vblank_at_or_after(&pacer, t - 1), k);
		}
	}
}

static void test_grid_of_120(void)
{
	struct pacer pacer;
	const struct pacer_params params = {.grid = {.numerator = 120, .denominator = 1}};
	pacer_init(&pacer, &params);
	CHECK_INT(pacer_vblank_time(&pacer, 1), 8333333);
	CHECK_INT(pacer_vblank_time(&pacer, 2), 16666666);
	CHECK_INT(pacer_vblank_time(&pacer, 3), 25000000);
	CHECK_INT(pacer_vblank_time(&pacer, 120 * 86400 * 365ull), 86400 * 365 * 1000000000ull);
}

/* 40 and 60 on 120: exact phases, exact counts. */
static void test_whole_ratios(void)
{
	for (uint32_t n = 2; n <= 4; n++) {
		const double fps = 120.0 / n;
		struct simulation s = {.refresh = {120, 1}, .fps = fps, .vblanks = 12000};
		simulate(&s);
		CHECK_NEAR((double)s.real, 12000.0 / n, 2);
		CHECK_NEAR((double)s.in_between, 12000.0 - 12000.0 / n, 6);
		CHECK_INT(s.wrong_n, 0);
		CHECK_NEAR(s.least_phase, 0, 0);
		CHECK_NEAR(s.most_phase, 0, 0);
		CHECK_NEAR(s.worst_step, 0, 1e-5);
		CHECK_INT(s.pacer.n, n);
		CHECK_NEAR(s.pacer.last_phase, (n - 1.0) / n, 1e-6);
	}
}

/* Ratios like 45 or 72 on 120: N alternates and is predicted, motion stays even. */
static void test_fractional_ratios(void)
{
	static const double rates[] = {45, 72, 50, 80, 48};
	for (size_t i = 0; i < sizeof(rates) / sizeof(rates[0]); i++) {
		struct simulation s = {.refresh = {120, 1}, .fps = rates[i], .vblanks = 12000};
		simulate(&s);
		CHECK_NEAR((double)s.real, 100 * rates[i], 2);
		CHECK(s.repeat <= 2); /* of the first frame, whose interval is not known */
		CHECK(s.wrong_n <= s.real / 100);
		/* first showings lie within a vblank around phase 0 (plain ones count as 0: up to 0.05 more) */
		CHECK(s.least_phase >= -0.5 * rates[i] / 120 - 0.02 && s.most_phase <= 0.5 * rates[i] / 120 + 0.02);
		CHECK(s.worst_step <= 0.05 * 120 / rates[i] + 0.01);
	}
}

static void test_any_rate_on_any_grid(void)
{
	static const uint64_t grids[][2] = {{120, 1}, {120000, 1001}, {1439, 10}};
	static const double rates[] = {30, 40, 45, 60000.0 / 1001, 60, 72, 90, 120, 144};
	static const double jitters[] = {0, 0.5, 2};
	for (size_t g = 0; g < 3; g++) {
		for (size_t r = 0; r < sizeof(rates) / sizeof(rates[0]); r++) {
			for (size_t j = 0; j < 3; j++) {
				struct simulation s = {.refresh = {grids[g][0], grids[g][1]},
									   .fps = rates[r],
									   .intake_jitter_ms = jitters[j],
									   .vblanks = 20000,
									   .declare = j == 1};
				const double hz = (double)grids[g][0] / (double)grids[g][1];
				simulate(&s);
				CHECK(s.real + s.in_between + s.repeat + 3 >= s.vblanks);
				if (rates[r] < hz * 0.95) {
					if (jitters[j] < 1000 / rates[r] - 1000 / hz) /* none lost: never two in one vblank */
						CHECK_NEAR((double)s.real, (double)s.frames, 1);
					CHECK(s.repeat <= 4); /* of the first frame */
					CHECK(s.most_phase <= 1.0 * rates[r] / hz + 0.05);
					CHECK(s.least_phase >= -1.0 * rates[r] / hz - 0.05);
				} else {
					CHECK_INT(s.in_between, 0);
					CHECK_NEAR(s.most_phase, 0, 0);
				}
			}
		}
	}
}

static void test_noise_of_the_client(void)
{
	struct simulation s = {
		.refresh = {120, 1}, .fps = 60, .time_jitter_ms = 1, .intake_jitter_ms = 1, .vblanks = 12000};
	simulate(&s);
	CHECK_NEAR((double)s.real, 6000, 3);
	CHECK_NEAR((double)s.pacer.interval_ns, 1e9 / 60, 0.6e6);
	CHECK(s.wrong_n < 60);
}

static void test_no_drift(void)
{
	struct simulation s = {.refresh = {120, 1}, .fps = 40, .vblanks = 1000000};
	simulate(&s);
	CHECK_NEAR((double)s.real, 1000000 / 3.0, 2);
	CHECK_INT(s.wrong_n, 0);
	CHECK_NEAR(s.most_phase, 0, 0);
	CHECK_NEAR(s.worst_step, 0, 1e-5);

	struct simulation t = {.refresh = {120000, 1001}, .fps = 60, .vblanks = 1000000};
	simulate(&t);
	CHECK_NEAR((double)t.real, (double)t.frames, 1);
	CHECK(t.worst_step < 0.12); /* a plain first showing is up to 0.05 T off */
}

static void feed(struct pacer *pacer, uint64_t id, uint64_t time_ns)
{
	const struct pacer_frame frame = {.frame_id = id, .time_ns = time_ns, .intake_ns = time_ns + 1000000};
	pacer_add_frame(pacer, &frame);
}

static void test_start_and_pause(void)
{
	struct pacer pacer;
	const struct pacer_params params = {.grid = {.numerator = 120, .denominator = 1}};
	struct pacer_decision d;
	pacer_init(&pacer, &params);
	CHECK_INT(pacer_decide(&pacer, 0).show, PACER_NOTHING);
	feed(&pacer, 1, 1000000);
	CHECK_INT(pacer_decide(&pacer, 1).show, PACER_REAL);
	CHECK_INT(pacer_decide(&pacer, 2).show, PACER_REPEAT); /* T is not known yet */
	for (uint64_t i = 1; i < 10; i++) {
		feed(&pacer, i + 1, 1000000 + i * 16666667);
		d = pacer_decide(&pacer, 1 + 2 * i);
		CHECK_INT(d.show, PACER_REAL);
		CHECK_INT(d.frame_id, i + 1);
		d = pacer_decide(&pacer, 2 + 2 * i);
		CHECK_INT(d.show, PACER_IN_BETWEEN);
		CHECK_NEAR(d.phase, 0.5, 0.01);
	}
	for (uint64_t k = 21; k <= 60; k++) { /* silence: phases 1, 1.5, 2, then the picture stays */
		d = pacer_decide(&pacer, k);
		CHECK_INT(d.show, k <= 23 ? PACER_IN_BETWEEN : PACER_REPEAT);
		CHECK_INT(d.frame_id, 10);
	}
	feed(&pacer, 11, 1000000 + 30 * 16666667u);
	d = pacer_decide(&pacer, 61);
	CHECK_INT(d.show, PACER_REAL);
	CHECK_INT(d.n, 2); /* the pause taught nothing */
}

static void test_newest_wins_and_missed(void)
{
	struct pacer pacer;
	const struct pacer_params params = {.grid = {.numerator = 120, .denominator = 1}};
	pacer_init(&pacer, &params);
	feed(&pacer, 1, 1000000);
	feed(&pacer, 2, 17666666);
	struct pacer_decision d = pacer_decide(&pacer, 3);
	CHECK_INT(d.frame_id, 2);
	pacer_missed(&pacer, &d);
	CHECK_INT(pacer.delay.count, 0);
	d = pacer_decide(&pacer, 4);
	CHECK_INT(d.show, PACER_REAL);
	CHECK_INT(d.frame_id, 2);
	d = pacer_decide(&pacer, 5);
	CHECK_INT(d.show, PACER_IN_BETWEEN);
	pacer_missed(&pacer, &d);
	CHECK_INT(pacer_decide(&pacer, 6).show, PACER_IN_BETWEEN);
	/* a vblank that was decided as an in-between becomes a real frame's if one comes in time */
	CHECK_INT(pacer_decide(&pacer, 7).show, PACER_IN_BETWEEN);
	feed(&pacer, 3, 34333332);
	CHECK_INT(pacer_decide(&pacer, 7).show, PACER_REAL);
}

static void test_fixed_delay(void)
{
	struct pacer pacer;
	const struct pacer_params params = {.grid = {.numerator = 120, .denominator = 1}, .fixed_delay = true};
	pacer_init(&pacer, &params);
	for (uint64_t i = 0; i < 100; i++) {
		feed(&pacer, i + 1, i * 25000000 + (i == 0));
		for (uint64_t k = 3 * i; k < 3 * i + 3; k++) {
			const struct pacer_decision d = pacer_decide(&pacer, k);
			CHECK_INT(d.show, k == 3 * i ? PACER_REAL : i == 0 ? PACER_REPEAT : PACER_IN_BETWEEN);
			if (i > 0) {
				CHECK_NEAR(d.phase, (double)(k - 3 * i) / 3, 1e-6);
				CHECK_INT(d.n, 3);
				CHECK_NEAR(d.last_phase, 2.0 / 3, 1e-6);
			}
		}
	}
	CHECK_INT(pacer.delay_ns, 0);
}

static void test_slower_client_moves_the_delay_slowly(void)
{
	struct pacer pacer;
	const struct pacer_params params = {.grid = {.numerator = 120, .denominator = 1}};
	pacer_init(&pacer, &params);
	uint64_t vblank = 0, id = 0;
	double before = -1, fastest = 0;
	for (uint64_t i = 0; i < 3000; i++) {
		const uint64_t late = i < 1000 ? 1 : 3; /* from 1000 on each frame comes 2 vblanks later */
		feed(&pacer, ++id, i * 25000000 + 1);
		for (vblank = 3 * i + late; vblank < 3 * i + late + 3; vblank++) {
			const struct pacer_decision d = pacer_decide(&pacer, vblank);
			const double moment = (double)i * 25.0 + d.phase * 25.0;
			if (before >= 0 && i > 20 && i != 1000 && fabs(d.phase) > 0.06 && d.phase < 1.9)
				fastest = fmax(fastest, fabs(moment - before - 8.333333));
			before = fabs(d.phase) > 0.06 ? moment : -1;
		}
	}
	CHECK_NEAR((double)pacer.delay_ns, 25e6, 10);
	CHECK(fastest < 8.333 * 0.08); /* 2% of three vblanks */
}

/* A steady client that now and then says an interval of 0, 1 us, 10 s or for ever, or repeats an old time. */
static void test_odd_intervals(void)
{
	static const uint64_t odd[] = {0, 1, 1000, UINT64_C(10000000000), UINT64_MAX};
	struct pacer pacer;
	const struct pacer_params params = {.grid = {.numerator = 120, .denominator = 1}};
	pacer_init(&pacer, &params);
	for (uint64_t i = 1; i <= 400; i++) {
		const bool strange = i % 8 == 0, backwards = i % 40 == 20;
		const struct pacer_frame frame = {.frame_id = i,
										  .time_ns = (backwards ? i - 10 : i) * 16666667,
										  .interval_ns = strange ? odd[i / 8 % 5] : 0,
										  .intake_ns = i * 16666667 + 1000000};
		pacer_add_frame(&pacer, &frame);
		for (uint64_t k = 2 * i + 1; k < 2 * i + 3; k++) {
			const struct pacer_decision d = pacer_decide(&pacer, k);
			CHECK(isfinite(d.phase) && d.phase >= -1.0 && d.n >= 1 && d.n <= 8);
			if (i > 12 && !backwards) {
				CHECK_INT(d.show, k % 2 ? PACER_REAL : PACER_IN_BETWEEN);
				CHECK_NEAR(d.phase, k % 2 ? 0.0 : 0.5, 0.03);
			}
		}
		if (i > 12)
			CHECK_NEAR((double)pacer.interval_ns, 1e9 / 60, 5e5);
	}
}

/* Phases beyond 1, of a frame that nothing follows: up to the greatest one, and then the picture stays. */
static void test_phase_beyond_one(void)
{
	static const double most[] = {0, 1, 3.5};
	for (size_t i = 0; i < 3; i++) {
		struct pacer pacer;
		const struct pacer_params params = {.grid = {.numerator = 120, .denominator = 1}, .max_phase = most[i]};
		const double expected = most[i] > 0 ? most[i] : 2.0;
		pacer_init(&pacer, &params);
		for (uint64_t id = 1; id <= 10; id++) {
			feed(&pacer, id, id * 16666667);
			pacer_decide(&pacer, 2 * id + 1);
		}
		for (uint64_t k = 22; k < 40; k++) {
			const struct pacer_decision d = pacer_decide(&pacer, k);
			const double phase = (double)(k - 21) / 2.0;
			CHECK_NEAR(d.phase, phase, 1e-3);
			CHECK_INT(d.show, phase <= expected && k < 29 ? PACER_IN_BETWEEN : PACER_REPEAT);
			CHECK(d.last_phase <= expected);
		}
	}
}

static void test_nonsense(void)
{
	static const uint64_t times[] = {0, 1, UINT64_MAX, INT64_MAX, (uint64_t)INT64_MAX + 1, 5, 1000000000, 3};
	struct pacer pacer;
	const struct pacer_params params = {.grid = {.numerator = 1439, .denominator = 10, .epoch_ns = 7}};
	pacer_init(&pacer, &params);
	for (uint64_t i = 0; i < 4000; i++) {
		random_unit();
		const struct pacer_frame frame = {i, times[random_state >> 8 & 7], times[random_state >> 12 & 7],
										  times[random_state >> 16 & 7]};
		if (i % 3 != 0)
			pacer_add_frame(&pacer, &frame);
		const struct pacer_decision d = pacer_decide(&pacer, i);
		CHECK(isfinite(d.phase) && isfinite(d.last_phase) && d.n >= 1 && d.n <= 8);
		CHECK(d.show != PACER_IN_BETWEEN || d.phase <= 2.0);
	}
	const struct pacer_params zero = {0};
	pacer_init(&pacer, &zero);
	CHECK_INT(pacer_vblank_time(&pacer, 3), 25000000);
}

int main(void)
{
	RUN(test_grid);
	RUN(test_grid_of_120);
	RUN(test_whole_ratios);
	RUN(test_fractional_ratios);
	RUN(test_any_rate_on_any_grid);
	RUN(test_noise_of_the_client);
	RUN(test_no_drift);
	RUN(test_start_and_pause);
	RUN(test_newest_wins_and_missed);
	RUN(test_fixed_delay);
	RUN(test_slower_client_moves_the_delay_slowly);
	RUN(test_odd_intervals);
	RUN(test_phase_beyond_one);
	RUN(test_nonsense);
	return test_result();
}
