/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The stream against daemons that refuse, hang, lie and send nonsense, and a process short of everything. */

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/client/harness.h"
#include "tests/test.h"

static void test_refused(void)
{
	const enum fake_manner manners[] = {FAKE_REFUSES_VERSION, FAKE_REFUSES_STREAM};
	const char *const reasons[] = {"version 1 is  [31mtoo old", "too many streams"};

	for (int i = 0; i < 2; i++) {
		struct fake_daemon daemon;
		CHECK(fake_start(&daemon, harness.path, manners[i]));
		int files = open_files();
		struct pursuit_stream *stream = open_stream(4);
		uint64_t sent = 0;
		for (const uint64_t end = now() + PATIENCE_NS; now() < end; sleep_ms(1)) {
			fake_step(&daemon);
			sent += send_frame(stream, 1) > 0;
			if (status_of(stream).state == PURSUIT_STATE_REFUSED)
				break;
		}
		CHECK_INT(status_of(stream).state, PURSUIT_STATE_REFUSED);
		CHECK_STRING(status_of(stream).message, reasons[i]);
		CHECK_INT(daemon.accepts, 1);
		CHECK_INT(status_of(stream).submitted, sent);
		CHECK(close_stream(&stream));
		fake_step(&daemon);
		CHECK_INT(open_files(), files);
		fake_stop(&daemon, true);
	}
}

/* Stopped, a daemon is as silent as one that hangs: frames replace each other. */
static void test_stopped(void)
{
	pid_t child = fake_fork(harness.path);
	CHECK(child > 0);
	struct pursuit_stream *stream = open_stream(4);

	CHECK(submit_until(stream, PURSUIT_STATE_ATTACHED));
	kill(child, SIGSTOP);
	CHECK_INT(waitpid(child, NULL, WUNTRACED), child);
	uint64_t before = status_of(stream).replaced;
	for (int i = 0; i < 500; i++) {
		CHECK(send_frame(stream, 1) > 0);
	}
	CHECK(status_of(stream).replaced - before >= 498);
	CHECK_INT(status_of(stream).no_slot, 0);
	kill(child, SIGKILL);
	waitpid(child, NULL, 0);
	CHECK(close_stream(&stream));
}

static void test_no_answer(void)
{
	const enum fake_manner manners[] = {FAKE_SILENT, FAKE_NOT_ACCEPTING};

	for (int i = 0; i < 2; i++) {
		struct fake_daemon daemon;
		CHECK(fake_start(&daemon, harness.path, manners[i]));
		/* More streams than the backlog of the second holds: its socket is full. */
		int count = manners[i] == FAKE_SILENT ? 1 : 4;
		struct pursuit_stream *streams[4];
		for (int k = 0; k < count; k++) {
			streams[k] = open_stream(4);
		}
		CHECK_INT(status_of(streams[0]).state, PURSUIT_STATE_ATTACHING);
		for (int k = 0; k < 200; k++) {
			fake_step(&daemon);
			CHECK(send_frame(streams[k % count], 1) > 0);
			CHECK(status_of(streams[k % count]).state != PURSUIT_STATE_ATTACHED);
			sleep_ms(k % 4 == 0);
		}
		if (manners[i] == FAKE_NOT_ACCEPTING) {
			CHECK_INT(status_of(streams[3]).state, PURSUIT_STATE_DETACHED);
		}
		for (int k = 0; k < count; k++) {
			CHECK(close_stream(&streams[k]));
		}
		fake_stop(&daemon, true);
	}
}

static void test_nonsense(void)
{
	for (int manner = FAKE_SHORT_PACKET; manner < FAKE_MANNERS; manner++) {
		struct fake_daemon daemon;
		CHECK(fake_start(&daemon, harness.path, (enum fake_manner)manner));
		int files = open_files();
		struct pursuit_stream *stream = open_stream(4);
		for (int i = 0; i < 30; i++) {
			fake_step(&daemon);
			CHECK(send_frame(stream, 1) > 0);
			sleep_ms(i < 10);
		}
		struct pursuit_status status = status_of(stream);
		if (manner == FAKE_BLOCKING_FULL_WAKE) {
			CHECK_INT(status.state, PURSUIT_STATE_ATTACHED);
		} else if (manner != FAKE_FLOOD) {
			CHECK(status.state != PURSUIT_STATE_ATTACHED);
		}
		printf("       nonsense %2d: %s\n", manner, status.message);
		CHECK(close_stream(&stream));
		fake_stop(&daemon, true);
		/* All that the daemon sent is closed; the listener itself was open before. */
		CHECK_INT(open_files(), files - 1);
	}
}

/* The daemon can change the eventfd at any time: full and blocking, it must not hold the game up. */
static void test_wake_is_filled(void)
{
	struct fake_daemon daemon;
	const uint64_t full = UINT64_MAX - 1;
	CHECK(fake_start(&daemon, harness.path, FAKE_BLOCKING_FULL_WAKE));
	struct pursuit_stream *stream = open_stream(4);

	CHECK(attach(stream, &daemon));
	CHECK(fcntl(daemon.wake, F_GETFL) & O_NONBLOCK);
	CHECK_INT(fcntl(daemon.wake, F_SETFL, 0), 0);
	CHECK_INT(write(daemon.wake, &full, sizeof(full)), sizeof(full));
	for (int i = 0; i < 10; i++) {
		CHECK(send_frame(stream, 1) > 0);
	}
	CHECK_INT(status_of(stream).published, 10);
	CHECK(close_stream(&stream));
	fake_stop(&daemon, true);
}

/* The daemon writes into the shared word what it may not. */
static void test_broken_word(void)
{
	struct fake_daemon daemon;
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(4);

	CHECK(attach(stream, &daemon));
	send_frame(stream, 1);
	struct pursuit_frame *kept = timed_acquire(stream);
	struct pursuit_frame *frame = timed_acquire(stream);
	daemon.control->latest = 0x5a5a5a5a;
	CHECK_INT(timed_submit(stream, frame), 2);
	CHECK_INT(status_of(stream).state, PURSUIT_STATE_DETACHED);
	CHECK(strstr(status_of(stream).message, "rules"));
	memset(kept->color.data, 9, kept->color.stride * kept->color.height);
	CHECK_INT(timed_submit(stream, kept), 3);
	CHECK_INT(send_frame(stream, 1), 4);
	CHECK(close_stream(&stream));
	fake_stop(&daemon, true);
}

/* Out of file descriptors at each step of the way; attached once there are some again. */
static void test_no_descriptors(void)
{
	struct rlimit old, small;
	CHECK_INT(getrlimit(RLIMIT_NOFILE, &old), 0);

	for (rlim_t spare = 0; spare < 5; spare++) {
		pid_t child = fake_fork(harness.path);
		int lowest = dup(0);
		close(lowest);
		small = (struct rlimit){.rlim_cur = (rlim_t)lowest + spare, .rlim_max = old.rlim_max};
		CHECK_INT(setrlimit(RLIMIT_NOFILE, &small), 0);
		struct pursuit_stream *stream = open_stream(4);
		for (int i = 0; i < 30; i++) {
			CHECK(send_frame(stream, 1) > 0);
			sleep_ms(2);
		}
		/* Enough of them: the daemon, a process of its own, is let run some time. */
		CHECK(spare < 3 || submit_until(stream, PURSUIT_STATE_ATTACHED));
		struct pursuit_status status = status_of(stream);
		CHECK_INT(status.state == PURSUIT_STATE_ATTACHED, spare >= 3);
		CHECK_INT(setrlimit(RLIMIT_NOFILE, &old), 0);
		printf("       %llu descriptors: %s\n", (unsigned long long)spare, status.message);
		CHECK(submit_until(stream, PURSUIT_STATE_ATTACHED));
		CHECK(close_stream(&stream));
		kill(child, SIGKILL);
		waitpid(child, NULL, 0);
	}
}

static void on_alarm(int signal)
{
}

/* Signals all the time: EINTR changes nothing. */
static void test_signals(void)
{
	struct sigaction action = {.sa_handler = on_alarm}, old;
	const timer_t none = 0;
	timer_t timer = none;
	struct itimerspec often = {.it_interval.tv_nsec = 50000, .it_value.tv_nsec = 50000};
	struct fake_daemon daemon;

	sigaction(SIGALRM, &action, &old);
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(4);
	CHECK_INT(timer_create(CLOCK_MONOTONIC, NULL, &timer), 0);
	timer_settime(timer, 0, &often, NULL);
	CHECK(attach(stream, &daemon));
	for (int i = 0; i < 2000; i++) {
		CHECK(send_frame(stream, 1) > 0);
	}
	timer_delete(timer);
	sigaction(SIGALRM, &old, NULL);
	CHECK_INT(status_of(stream).attaches, 1);
	CHECK_INT(fake_wakes(&daemon), 2000);
	CHECK(close_stream(&stream));
	fake_stop(&daemon, true);
}

int main(void)
{
	if (!harness_start()) {
		return 1;
	}
	RUN(test_refused);
	RUN(test_stopped);
	RUN(test_no_answer);
	RUN(test_nonsense);
	RUN(test_wake_is_filled);
	RUN(test_broken_word);
	RUN(test_no_descriptors);
	RUN(test_signals);
	harness_finish();
	return test_result();
}
