/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The reading end of the feedback ring: order, overruns, half-written entries, nonsense, and a race. */

#include <pthread.h>

#include "client/feedback.h"
#include "tests/client/fake_daemon.h"
#include "tests/test.h"

static struct pursuit_shm_control control;

static struct fake_daemon fresh_daemon(void)
{
	memset(&control, 0, sizeof(control));
	return (struct fake_daemon){.control = &control};
}

static void test_order(void)
{
	struct fake_daemon daemon = fresh_daemon();
	struct shim_feedback feedback = {0};
	struct pursuit_feedback_report report;

	CHECK(!shim_feedback_poll(&feedback, &control, &report));
	for (uint64_t id = 1; id <= 3; id++) {
		fake_report(&daemon, id, id == 2 ? PURSUIT_FEEDBACK_REPLACED : PURSUIT_FEEDBACK_SHOWN);
	}
	for (uint64_t id = 1; id <= 3; id++) {
		CHECK(shim_feedback_poll(&feedback, &control, &report));
		CHECK_INT(report.frame_id, id);
		CHECK_INT(report.flip_ns, 1000 + id);
		CHECK_INT(report.shown, id == 2 ? PURSUIT_REPLACED : PURSUIT_SHOWN);
	}
	CHECK(!shim_feedback_poll(&feedback, &control, &report));
}

/* The oldest are lost, never the newest. */
static void test_overrun(void)
{
	struct fake_daemon daemon = fresh_daemon();
	struct shim_feedback feedback = {0};
	struct pursuit_feedback_report report;

	for (uint64_t id = 1; id <= 1000; id++) {
		fake_report(&daemon, id, PURSUIT_FEEDBACK_SHOWN);
	}
	for (uint64_t id = 1000 - PURSUIT_FEEDBACK_ENTRIES + 1; id <= 1000; id++) {
		CHECK(shim_feedback_poll(&feedback, &control, &report));
		CHECK_INT(report.frame_id, id);
	}
	CHECK(!shim_feedback_poll(&feedback, &control, &report));
}

static void test_half_written(void)
{
	struct fake_daemon daemon = fresh_daemon();
	struct shim_feedback feedback = {0};
	struct pursuit_feedback_report report;

	for (uint64_t id = 1; id <= PURSUIT_FEEDBACK_ENTRIES; id++) {
		fake_report(&daemon, id, PURSUIT_FEEDBACK_SHOWN);
	}
	control.feedback[0].sequence = 2 * PURSUIT_FEEDBACK_ENTRIES + 1;
	CHECK(shim_feedback_poll(&feedback, &control, &report));
	CHECK_INT(report.frame_id, 2);
}

static void test_nonsense(void)
{
	struct fake_daemon daemon = fresh_daemon();
	struct shim_feedback feedback = {0};
	struct pursuit_feedback_report report;

	fake_report(&daemon, 1, 99);
	fake_report(&daemon, 2, 0);
	CHECK(!shim_feedback_poll(&feedback, &control, &report));
	control.feedback_count = UINT64_MAX;
	CHECK(!shim_feedback_poll(&feedback, &control, &report));
	control.feedback_count = 0;
	CHECK(!shim_feedback_poll(&feedback, &control, &report));
}

#define RACE_REPORTS 200000

static void *race_daemon(void *argument)
{
	struct fake_daemon *daemon = argument;
	for (uint64_t id = 1; id <= RACE_REPORTS; id++) {
		fake_report(daemon, id, PURSUIT_FEEDBACK_SHOWN);
	}
	return NULL;
}

static void test_race(void)
{
	struct fake_daemon daemon = fresh_daemon();
	struct shim_feedback feedback = {0};
	struct pursuit_feedback_report report;
	uint64_t last = 0, wrong = 0, got = 0;
	pthread_t thread;

	CHECK_INT(pthread_create(&thread, NULL, race_daemon, &daemon), 0);
	while (last < RACE_REPORTS) {
		if (shim_feedback_poll(&feedback, &control, &report)) {
			wrong += report.flip_ns != 1000 + report.frame_id || report.frame_id <= last;
			last = report.frame_id;
			got++;
		}
	}
	pthread_join(thread, NULL);
	CHECK_INT(wrong, 0);
	printf("       %llu of %d reports read\n", (unsigned long long)got, RACE_REPORTS);
}

int main(void)
{
	RUN(test_order);
	RUN(test_overrun);
	RUN(test_half_written);
	RUN(test_nonsense);
	RUN(test_race);
	return test_result();
}
