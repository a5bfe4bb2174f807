/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* When the attach machine tries, waits and gives up, with the time passed in: no test here waits for real. */

#include "client/attach.h"
#include "tests/client/harness.h"
#include "tests/test.h"

static struct shim_layout layout;
static struct shim_attach machine;
static uint64_t time_ns;

static void begin(void)
{
	const struct pursuit_stream_params params = {.width = 16, .height = 16};

	CHECK(shim_layout_init(&layout, &params));
	CHECK(shim_attach_init(&machine, harness.path, "clock"));
	time_ns = 1000 * MS;
}

/* One step, and the slots to nobody. */
static enum shim_attach_change step(uint64_t later_ns)
{
	time_ns += later_ns;
	enum shim_attach_change change = shim_attach_step(&machine, &layout, time_ns);
	if (change == SHIM_ATTACH_GAINED) {
		shim_slots_destroy(&machine.offered);
	}
	return change;
}

/* The requirement: attached within 100 ms of the daemon's return, whatever the game's rate from 30 a second up. */
static void test_back_within_100_ms(void)
{
	const uint64_t intervals[] = {33333333, 16666667, 8333333, 25000000, 1000000};

	for (size_t i = 0; i < sizeof(intervals) / sizeof(*intervals); i++) {
		for (uint64_t away = 0; away < 40; away += 3) {
			struct fake_daemon daemon;
			begin();
			/* Away for up to half an hour, in steps that shift the daemon's return against the game's frames. */
			for (uint64_t passed = 0; passed < away * away * 1000 * MS; passed += 997 * MS) {
				step(997 * MS);
			}
			for (uint64_t k = 0; k < away; k++) {
				step(intervals[i]);
			}
			uint64_t since = time_ns;
			CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
			while (machine.state != PURSUIT_STATE_ATTACHED && time_ns - since < 1000 * MS) {
				/* One call a frame is fewer than a game makes. */
				step(intervals[i]);
				fake_step(&daemon);
			}
			CHECK(machine.state == PURSUIT_STATE_ATTACHED);
			CHECK(time_ns - since <= 100 * MS);
			shim_attach_finish(&machine);
			fake_stop(&daemon, true);
		}
	}
}

static void test_tries_are_few(void)
{
	int tries = 0;

	begin();
	for (int i = 0; i < 10000; i++) {
		uint64_t due = machine.next_try_ns;
		step(MS);
		tries += machine.next_try_ns != due;
	}
	CHECK(tries > 100 && tries <= 10000 / 25 + 4);
	shim_attach_finish(&machine);
}

static void test_patience(void)
{
	struct fake_daemon daemon;

	CHECK(fake_start(&daemon, harness.path, FAKE_SILENT));
	begin();
	step(0);
	CHECK_INT(machine.state, PURSUIT_STATE_ATTACHING);
	step(4999 * MS);
	CHECK_INT(machine.state, PURSUIT_STATE_ATTACHING);
	step(MS);
	CHECK_INT(machine.state, PURSUIT_STATE_DETACHED);
	CHECK(machine.offered == NULL && machine.socket < 0);
	step(25 * MS);
	CHECK_INT(machine.state, PURSUIT_STATE_ATTACHING);
	shim_attach_finish(&machine);
	fake_stop(&daemon, true);
}

static void test_refused_is_rare(void)
{
	struct fake_daemon daemon;

	CHECK(fake_start(&daemon, harness.path, FAKE_REFUSES_STREAM));
	begin();
	for (int i = 0; i < 100; i++) {
		step(100 * MS);
		fake_step(&daemon);
	}
	CHECK(daemon.accepts >= 4 && daemon.accepts <= 6);
	shim_attach_finish(&machine);
	fake_stop(&daemon, true);
}

int main(void)
{
	if (!harness_start()) {
		return 1;
	}
	RUN(test_back_within_100_ms);
	RUN(test_tries_are_few);
	RUN(test_patience);
	RUN(test_refused_is_rare);
	harness_finish();
	return test_result();
}
