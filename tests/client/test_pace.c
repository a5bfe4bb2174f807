/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* When to begin the next frame: by hints good and bad, in a loop with a simulated display, and with a daemon that dies.
 */

#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "client/pace.h"
#include "client/pursuit.h"
#include "tests/client/fake_daemon.h"
#include "tests/test.h"

#define MS UINT64_C(1000000)
#define NOW (UINT64_C(5000) * MS)

static struct pursuit_shm_control control;

static void hint(uint64_t frame_id, uint64_t next_submit_ns, uint64_t interval_ns)
{
	control.hint.sequence += 2;
	control.hint.frame_id = frame_id;
	control.hint.next_submit_ns = next_submit_ns;
	control.hint.interval_ns = interval_ns;
}

static void test_without_hint(void)
{
	struct shim_pace pace = {0};
	memset(&control, 0, sizeof(control));
	CHECK_INT(shim_pace_start(&pace, &control, 1, NOW), 0);
	hint(1, 0, 16 * MS);
	CHECK_INT(shim_pace_start(&pace, &control, 2, NOW), 0);
}

static void test_start_is_before_the_deadline_by_the_work(void)
{
	struct shim_pace pace = {0};
	memset(&control, 0, sizeof(control));
	hint(7, NOW + 20 * MS, 16 * MS);
	CHECK_INT(shim_pace_start(&pace, &control, 8, NOW), NOW + 19 * MS + MS / 2);
	CHECK_INT(shim_pace_start(&pace, &control, 9, NOW), NOW + 35 * MS + MS / 2);
	shim_pace_begin(&pace, 8, NOW);
	shim_pace_publish(&pace, 8, NOW + 5 * MS);
	CHECK_INT(shim_pace_start(&pace, &control, 9, NOW), NOW + 30 * MS + MS / 2);
	/* published again, or never begun: teaches nothing */
	shim_pace_publish(&pace, 8, NOW + 90 * MS);
	shim_pace_publish(&pace, 12, NOW + 90 * MS);
	CHECK_INT(shim_pace_start(&pace, &control, 9, NOW), NOW + 30 * MS + MS / 2);
	/* the longest of eight, and after eight shorter ones no more */
	for (uint64_t id = 9; id < 17; id++) {
		shim_pace_begin(&pace, id, NOW);
		shim_pace_publish(&pace, id, NOW + (id == 9 ? 7 : 2) * MS);
		hint(id, NOW + 20 * MS, 16 * MS);
		CHECK_INT(shim_pace_start(&pace, &control, id + 1, NOW), NOW + 12 * MS + MS / 2);
	}
	shim_pace_begin(&pace, 17, NOW);
	shim_pace_publish(&pace, 17, NOW + 2 * MS);
	hint(17, NOW + 20 * MS, 16 * MS);
	CHECK_INT(shim_pace_start(&pace, &control, 18, NOW), NOW + 17 * MS + MS / 2);
}

/* Two frames under way, as with read-backs: each is measured from its own beginning. */
static void test_frames_under_way(void)
{
	struct shim_pace pace = {0};
	memset(&control, 0, sizeof(control));
	shim_pace_begin(&pace, 1, NOW);
	shim_pace_begin(&pace, 2, NOW + 16 * MS);
	shim_pace_publish(&pace, 1, NOW + 20 * MS);
	hint(1, NOW + 40 * MS, 16 * MS);
	CHECK_INT(shim_pace_start(&pace, &control, 3, NOW), NOW + 40 * MS + 16 * MS - 20 * MS - MS / 2);
}

static void test_nonsense(void)
{
	static const uint64_t values[] = {0, 1, UINT64_MAX, INT64_MAX, NOW, NOW + 10 * MS, MS, 300 * MS, 16 * MS};
	struct shim_pace pace = {0};
	uint32_t state = 5;
	memset(&control, 0, sizeof(control));
	for (int i = 0; i < 20000; i++) {
		state = state * 1664525u + 1013904223u;
		control.hint.sequence = i % 3 ? 2 : values[(state >> 28) % 9];
		control.hint.frame_id = i % 5 ? 10 : values[(state >> 24) % 9];
		control.hint.next_submit_ns = values[(state >> 16) % 9];
		control.hint.interval_ns = values[(state >> 8) % 9];
		uint64_t start = shim_pace_start(&pace, &control, 11 + (state >> 5) % 3, NOW);
		CHECK(start == 0 || (start <= NOW + 250 * MS && start + 1001 * MS >= NOW));
	}
	control.hint = (struct pursuit_hint){3, 10, NOW + MS, 16 * MS}; /* half written */
	CHECK_INT(shim_pace_start(&pace, &control, 11, NOW), 0);
}

/*
 * A 120 Hz display, a client of 60 that works for 6 ms, and hints as the daemon gives them: it is led to submit just
 * before each deadline, and its frames are on display 6 ms younger than when it ran freely.
 */
static void test_it_locks_to_the_display(void)
{
	const double period = 1e9 / 120, lead = 4e6, work = 6e6;
	struct shim_pace pace = {0};
	double now = 1e9 + 1234567, oldest = 0;
	uint64_t shown_before = 0;
	memset(&control, 0, sizeof(control));
	for (uint64_t id = 1; id <= 200; id++) {
		uint64_t start = shim_pace_start(&pace, &control, id, (uint64_t)now);
		if (start > (uint64_t)now) {
			now = (double)start + 60000.0; /* wake-ups are late */
		}
		const double begun = now;
		shim_pace_begin(&pace, id, (uint64_t)now);
		now += work;
		shim_pace_publish(&pace, id, (uint64_t)now);
		uint64_t shown = (uint64_t)ceil((now + lead - 1e6) / period);
		hint(id, (uint64_t)((double)(shown + 2) * period - lead), (uint64_t)(2 * period));
		if (id > 20) {
			CHECK_INT(shown - shown_before, 2);
			oldest = fmax(oldest, (double)shown * period - begun);
		}
		shown_before = shown;
	}
	CHECK(oldest < work + lead + 1e6);
}

static uint64_t monotonic(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000 * MS + (uint64_t)now.tv_nsec;
}

/* No daemon, no hint, no time: every call comes back, and soon. Bounds are generous: it must not hang. */
static void test_waiting_is_bounded(void)
{
	char path[100];
	snprintf(path, sizeof(path), "/tmp/pursuit-pace-%d", (int)getpid());
	const struct pursuit_stream_params params = {.width = 16, .height = 16, .socket_path = path};
	CHECK_INT(pursuit_wait_next(NULL, 1), 0);
	CHECK_INT(pursuit_next_start(NULL), 0);
	struct pursuit_stream *stream = pursuit_open(&params);
	const uint64_t before = monotonic();
	CHECK_INT(pursuit_wait_next(stream, UINT64_MAX), 0);
	pid_t daemon = fake_fork(path);
	CHECK(daemon > 0);
	for (int i = 0; i < 100; i++) {
		struct pursuit_frame *frame = pursuit_acquire(stream);
		if (frame) {
			pursuit_submit(stream, frame);
		}
		pursuit_wait_next(stream, MS);
	}
	kill(daemon, SIGKILL);
	waitpid(daemon, NULL, 0);
	CHECK_INT(pursuit_wait_next(stream, UINT64_MAX), 0);
	CHECK(monotonic() - before < 60000 * MS);
	pursuit_close(&stream);
	unlink(path);
}

int main(void)
{
	RUN(test_without_hint);
	RUN(test_start_is_before_the_deadline_by_the_work);
	RUN(test_frames_under_way);
	RUN(test_nonsense);
	RUN(test_it_locks_to_the_display);
	RUN(test_waiting_is_bounded);
	return test_result();
}
