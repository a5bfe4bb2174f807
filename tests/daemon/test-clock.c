/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The clock that spins: over one whose sleepers are woken too late, by 50 us. */
#include "daemon/clock.h"
#include "tests/test.h"

#define LATE_NS 50000u

struct sleepy {
	struct clock clock;
	uint64_t now_ns, slept_until_ns;
	unsigned looks;
};

static uint64_t sleepy_now(struct clock *clock)
{
	struct sleepy *sleepy = (struct sleepy *)clock;
	sleepy->looks++;
	return sleepy->now_ns += 100;
}

static void sleepy_wait_until(struct clock *clock, uint64_t time_ns)
{
	struct sleepy *sleepy = (struct sleepy *)clock;
	sleepy->slept_until_ns = time_ns;
	if (time_ns > sleepy->now_ns)
		sleepy->now_ns = time_ns + LATE_NS;
}

static void init(struct sleepy *sleepy, struct clock_spinning *spinning, uint64_t spin_ns)
{
	*sleepy = (struct sleepy){{sleepy_now, sleepy_wait_until}, 1000000, 0, 0};
	clock_init_spinning(spinning, &sleepy->clock, spin_ns);
}

static void test_is_on_time(void)
{
	struct sleepy sleepy;
	struct clock_spinning spinning;
	init(&sleepy, &spinning, 2 * LATE_NS);
	clock_wait_until(&spinning.clock, 9000000);
	CHECK_INT(sleepy.slept_until_ns, 9000000 - 2 * LATE_NS);
	CHECK(sleepy.now_ns >= 9000000 && sleepy.now_ns < 9000200);
	/* Only what was left of it. */
	CHECK(sleepy.looks <= LATE_NS / 100 + 2);
	CHECK(clock_now(&spinning.clock) < 9000400);
}

static void test_too_short_a_spin(void)
{
	struct sleepy sleepy;
	struct clock_spinning spinning;
	init(&sleepy, &spinning, LATE_NS / 2);
	clock_wait_until(&spinning.clock, 9000000);
	CHECK(sleepy.now_ns < 9000000 + LATE_NS / 2 + 200);
	CHECK_INT(sleepy.looks, 1);
}

static void test_no_spin(void)
{
	struct sleepy sleepy;
	struct clock_spinning spinning;
	init(&sleepy, &spinning, 2 * LATE_NS);
	clock_set_spin(&spinning, 0);
	clock_wait_until(&spinning.clock, 9000000);
	CHECK_INT(sleepy.slept_until_ns, 9000000);
	CHECK_INT(sleepy.looks, 1);
}

static void test_times_that_are_over(void)
{
	struct sleepy sleepy;
	struct clock_spinning spinning;
	init(&sleepy, &spinning, 2 * LATE_NS);
	clock_wait_until(&spinning.clock, 900000);
	clock_wait_until(&spinning.clock, 0);
	clock_wait_until(&spinning.clock, LATE_NS);
	CHECK(sleepy.now_ns < 1000500);
}

int main(void)
{
	RUN(test_is_on_time);
	RUN(test_too_short_a_spin);
	RUN(test_no_spin);
	RUN(test_times_that_are_over);
	return test_result();
}
