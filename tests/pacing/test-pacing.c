/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Bounds on what the pacer does with simulated displays and clients: 10,000 vblanks each, the same everywhere. */

#include <math.h>

#include "tests/pacing/simulation.h"
#include "tests/test.h"

#define VBLANKS 10000u
/* Up to 0.05 a real frame is shown plain rather than warped, so an even march is kept within that. */
#define PHASE_MOST 0.0505

static const struct simulated_display *display_of(const char *name)
{
	const struct simulated_display *display = simulated_displays;
	while (strcmp(display->name, name) != 0)
		display++;
	return display;
}

static const struct simulated_client *client_of(const char *name)
{
	const struct simulated_client *client = simulated_clients;
	while (strcmp(client->name, name) != 0)
		client++;
	return client;
}

static void run(const char *display, const char *client, uint64_t vblanks, struct simulation_result *result)
{
	const struct simulation simulation = {
		.display = *display_of(display), .client = *client_of(client), .vblanks = vblanks};
	const int before = test_failed();
	simulation_run(&simulation, result);
	/*
	 * What holds for all of them. A real frame is later than it could be only while nobody knows the display: for the
	 * eight stamps after it has stepped, or where noise in them misleads.
	 */
	const double noisy = simulation.display.noise_us > 0 ? 0.015 : 0.0015;
	const double lost = simulation.display.miss + noisy;
	CHECK(result->late <= (simulation.display.step_hz > 0 ? 6u : simulation.display.noise_us > 0 ? 2u : 0u));
	CHECK(result->most_late <= 1);
	CHECK(result->dropped <= 2 + (lost > 0.01 ? lost * (double)vblanks : 0));
	CHECK(result->doubled <= 6);
	const double shown = (double)(result->real + result->in_betweens + result->repeats);
	CHECK(shown >= (double)result->vblanks * (0.98 - 1.5 * simulation.display.miss));
	if (test_failed() != before)
		printf("       ... %s on %s\n", client, display);
}

static const char *const steady[] = {"23.976", "30", "40",  "45",  "59.94", "60",
									 "72",     "90", "119", "120", "144",   "60 declared"};
#define STEADY (sizeof(steady) / sizeof(steady[0]))

/* Exactly even motion: the delay does not move, no phase error accumulates, N is what was predicted. */
static void test_steady_clients(void)
{
	static const char *const displays[] = {"120", "119.88", "143.9", "60"};
	for (size_t d = 0; d < 4; d++) {
		for (size_t c = 0; c < STEADY; c++) {
			struct simulation_result r;
			run(displays[d], steady[c], VBLANKS, &r);
			CHECK_NEAR(r.phase_p99, 0, 0.05);
			CHECK_NEAR(r.phase_most, 0, PHASE_MOST);
			CHECK_NEAR(r.delay_span_ms, 0, d == 3 && c == 10 ? 1.5 : 1e-3); /* 144 on 60 passes through */
			CHECK(r.in_betweens == 0 || r.wrong_n <= 0.012 * (double)r.real);
		}
	}
}

/* Ratios that go up exactly: every first showing is plain, from the first second on. */
static void test_exact_ratios_are_plain(void)
{
	static const char *const clients[] = {"30", "40", "60"};
	struct simulation_result r;
	for (size_t c = 0; c < 3; c++) {
		run("120", clients[c], VBLANKS, &r);
		CHECK_INT(r.plain, r.real);
		CHECK_NEAR(r.phase_most, 0, 1e-5);
		CHECK_INT(r.wrong_n, 1); /* the first, before T is known */
	}
	run("119.88", "59.94", VBLANKS, &r);
	CHECK(r.plain >= r.real - 100);
}

/* Two crystals that differ by 83 millionths: the delay follows, slowly, and real frames stay plain. */
static void test_crystals_that_differ(void)
{
	for (size_t c = 1; c < STEADY; c++) {
		struct simulation_result r;
		run("119.99", steady[c], VBLANKS, &r);
		CHECK_NEAR(r.phase_p99, 0, 0.05);
		CHECK(r.delay_span_ms < 2.0); /* in 21 s */
	}
}

/* 23.976 on 120 and 143.9 Hz, which slip by a vblank in 8 and 23 s: ten minutes without a beat. */
static void test_ten_minutes_of_film(void)
{
	static const char *const displays[] = {"120", "143.9"};
	for (size_t d = 0; d < 2; d++) {
		struct simulation_result r;
		run(displays[d], "23.976", d == 0 ? 72000 : 86340, &r);
		CHECK_NEAR(r.phase_most, 0, PHASE_MOST);
		CHECK_NEAR(r.delay_span_ms, 0, 1e-3);
		CHECK_NEAR((double)r.real, 600 * 23.976, 2);
		CHECK(r.wrong_n < 200);
	}
}

/* Noise in times and arrivals, stalls, bursts. */
static void test_unsteady_clients(void)
{
	static const char *const clients[] = {"60 normal", "60 tail", "45 tail", "60 stalls", "60 bursts"};
	static const char *const displays[] = {"120", "119.88", "143.9", "60", "119.88 jitter", "120 misses"};
	for (size_t d = 0; d < 6; d++) {
		for (size_t c = 0; c < 5; c++) {
			struct simulation_result r;
			run(displays[d], clients[c], VBLANKS, &r);
			CHECK_NEAR(r.phase_p99, 0, 0.0525);
			CHECK_NEAR(r.phase_most, 0, 0.07);
		}
		struct simulation_result r;
		run(displays[d], "50 uneven", VBLANKS, &r);
		CHECK(d == 3 || r.phase_p99 < 0.1);
	}
}

/* Stamps with jitter and tails, flips that are missed. */
static void test_unsteady_displays(void)
{
	for (size_t c = 0; c < STEADY; c++) {
		struct simulation_result r;
		run("119.88 jitter", steady[c], VBLANKS, &r);
		CHECK_NEAR(r.phase_p99, 0, 0.051);
		CHECK_NEAR(r.vblank_us_off, 0, 130);
		run("120 misses", steady[c], VBLANKS, &r);
		CHECK_NEAR(r.phase_p99, 0, 0.05);
		CHECK_NEAR(r.vblank_us_off, 0, 20);
	}
}

/* Where it takes longer to settle, and why. */
static double settling_bound(const struct simulated_display *display, const struct simulated_client *client)
{
	/* The rates' crystals slip by a vblank in 100 s, and this falls into the seconds after the ramp. */
	if (strcmp(display->name, "119.99") == 0 && client->ramps)
		return HUGE_VAL;
	/* Half a ms of noise in each moment hides for a hundred frames that 60 is not 59.94. */
	if (strncmp(display->name, "119.88", 6) == 0 && strcmp(client->name, "60 normal") == 0)
		return 2.0;
	/* It stops for 0.3 s just then. */
	return display->step_hz > 0.0 && client->stall_ms > 0.0 ? 0.8 : 0.5;
}

/* From the start on, after steps of client and display, ramps, and sleep. */
static void test_all_settle_in_half_a_second(void)
{
	for (const struct simulated_display *d = simulated_displays; d->name; d++) {
		for (const struct simulated_client *c = simulated_clients; c->name; c++) {
			const int before = test_failed();
			struct simulation_result r;
			run(d->name, c->name, VBLANKS, &r);
			CHECK(!(r.settle_s > settling_bound(d, c)));
			if (c->noise_ms == 0.0 && c->uneven == 0.0 && !c->ramps)
				CHECK_NEAR(r.phase_p99, 0, 0.05);
			if (test_failed() != before)
				printf("       ... %s on %s\n", c->name, d->name);
		}
	}
}

/* Half the rate without a count of vblanks might as well be every second stamp missed. */
static void test_half_the_rate_uncounted(void)
{
	for (size_t c = 0; c < STEADY; c++) {
		struct simulation s = {
			.display = *display_of("120 to 60"), .client = *client_of(steady[c]), .vblanks = VBLANKS};
		struct simulation_result r;
		s.display.counts = false;
		simulation_run(&s, &r);
		CHECK(r.settle_s < 0.7); /* of which 0.27 pass until it is believed */
		CHECK_NEAR(r.phase_p99, 0, 0.05);
	}
}

/* The client stops for half a minute, again and again: what was learned before holds after. */
static void test_long_stalls(void)
{
	static const char *const clients[] = {"23.976", "30", "45", "59.94", "60"};
	static const char *const displays[] = {"120", "143.9"};
	for (size_t d = 0; d < 2; d++) {
		for (size_t c = 0; c < 5; c++) {
			struct simulation s = {
				.display = *display_of(displays[d]), .client = *client_of(clients[c]), .vblanks = 4 * VBLANKS};
			struct simulation_result r;
			s.client.stall_ms = 30000;
			simulation_run(&s, &r);
			CHECK_NEAR(r.phase_most, 0, PHASE_MOST);
			CHECK_NEAR(r.delay_span_ms, 0, 1e-3);
			CHECK(r.repeats > r.vblanks / 2 && r.in_betweens > 400); /* it did stop, and it did play */
			CHECK_INT(r.late, 0);
			CHECK(r.dropped <= 1 &&
				  r.doubled <= 12); /* the last before each stall stays for eight vblanks, then as a repeat */
		}
	}
}

/* The same seed, the same figures; another seed, others. */
static void test_chance_is_repeatable(void)
{
	struct simulation s = {.display = *display_of("119.88 jitter"), .client = *client_of("60 normal"), .vblanks = 2000};
	struct simulation_result a, b;
	simulation_run(&s, &a);
	simulation_run(&s, &b);
	CHECK(memcmp(&a, &b, sizeof(a)) == 0);
	s.seed = 2;
	simulation_run(&s, &b);
	CHECK(memcmp(&a, &b, sizeof(a)) != 0);
}

int main(void)
{
	RUN(test_steady_clients);
	RUN(test_exact_ratios_are_plain);
	RUN(test_crystals_that_differ);
	RUN(test_ten_minutes_of_film);
	RUN(test_unsteady_clients);
	RUN(test_unsteady_displays);
	RUN(test_all_settle_in_half_a_second);
	RUN(test_half_the_rate_uncounted);
	RUN(test_long_stalls);
	RUN(test_chance_is_repeatable);
	return test_result();
}
