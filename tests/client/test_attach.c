/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The stream against daemons that are missing, good, refusing, killed, silent
 * and lying. Every call of the shim is timed: none may wait.
 */

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "tests/client/fake_daemon.h"
#include "tests/test.h"

/* Loose, for a loaded machine: a call that waits for anything would take far longer. */
#define AT_ONCE_NS UINT64_C(100000000)
#define MS UINT64_C(1000000)

static char folder[] = "/tmp/pursuit-test-XXXXXX";
static char path[64];
static uint64_t slowest_ns;

static uint64_t now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

static void sleep_ms(long ms)
{
	nanosleep(&(struct timespec){.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000}, NULL);
}

static void note_time(uint64_t begin)
{
	uint64_t spent = now() - begin;
	slowest_ns = spent > slowest_ns ? spent : slowest_ns;
}

static struct pursuit_frame *timed_acquire(struct pursuit_stream *stream)
{
	uint64_t begin = now();
	struct pursuit_frame *frame = pursuit_acquire(stream);
	note_time(begin);
	return frame;
}

static uint64_t timed_submit(struct pursuit_stream *stream, struct pursuit_frame *frame)
{
	uint64_t begin = now();
	uint64_t id = pursuit_submit(stream, frame);
	note_time(begin);
	return id;
}

static struct pursuit_stream *open_stream(uint32_t slot_count)
{
	struct pursuit_stream_params params = {
		.width = 64,
		.height = 32,
		.depth_format = PURSUIT_DEPTH_FLOAT32,
		.slot_count = slot_count,
		.socket_path = path,
		.name = "a test",
	};
	uint64_t begin = now();
	struct pursuit_stream *stream = pursuit_open(&params);
	note_time(begin);
	CHECK(stream != NULL);
	return stream;
}

static void close_stream(struct pursuit_stream **stream)
{
	uint64_t begin = now();
	pursuit_close(stream);
	note_time(begin);
	CHECK(*stream == NULL);
	CHECK(slowest_ns < AT_ONCE_NS);
	printf("       slowest call: %.1f us\n", (double)slowest_ns * 1e-3);
	slowest_ns = 0;
}

static struct pursuit_status status_of(struct pursuit_stream *stream)
{
	struct pursuit_status status;
	pursuit_get_status(stream, &status);
	return status;
}

/* One frame filled with its number. */
static uint64_t send_frame(struct pursuit_stream *stream, uint8_t value)
{
	struct pursuit_frame *frame = timed_acquire(stream);
	if (!frame) {
		return 0;
	}
	memset(frame->color.data, value, frame->color.stride * frame->color.height);
	memset(frame->depth.data, value, frame->depth.stride * frame->depth.height);
	return timed_submit(stream, frame);
}

/* Steps both sides until attached; the time between tries has to pass. */
static bool attach(struct pursuit_stream *stream, struct fake_daemon *daemon)
{
	for (int i = 0; i < 400 && status_of(stream).state != PURSUIT_STATE_ATTACHED; i++) {
		fake_step(daemon);
		pursuit_update(stream);
		sleep_ms(1);
	}
	return status_of(stream).state == PURSUIT_STATE_ATTACHED;
}

static int open_files(void)
{
	DIR *directory = opendir("/proc/self/fd");
	int count = 0;

	while (directory && readdir(directory)) {
		count++;
	}
	closedir(directory);
	return count;
}

static void test_parameters(void)
{
	struct pursuit_stream_params params = {.width = 0, .height = 32};
	char long_path[200];

	errno = 0;
	CHECK(pursuit_open(&params) == NULL);
	CHECK_INT(errno, EINVAL);
	CHECK(pursuit_open(NULL) == NULL);
	memset(long_path, 'x', sizeof(long_path));
	long_path[sizeof(long_path) - 1] = '\0';
	params.width = 32;
	params.socket_path = long_path;
	errno = 0;
	CHECK(pursuit_open(&params) == NULL);
	CHECK_INT(errno, EINVAL);
	CHECK_STRING(pursuit_version(), "0.1.0");
}

static void test_null(void)
{
	struct pursuit_stream *none = NULL;
	struct pursuit_feedback_report report;
	struct pursuit_status status;

	pursuit_close(&none);
	pursuit_close(NULL);
	pursuit_update(NULL);
	CHECK(pursuit_acquire(NULL) == NULL);
	CHECK_INT(pursuit_submit(NULL, NULL), 0);
	pursuit_cancel(NULL, NULL);
	CHECK_INT(pursuit_poll_feedback(NULL, &report), 0);
	pursuit_get_status(NULL, &status);
	CHECK_INT(status.state, PURSUIT_STATE_DETACHED);
}

static void test_no_daemon(void)
{
	int files = open_files();
	unlink(path);
	struct pursuit_stream *stream = open_stream(0);
	struct pursuit_feedback_report report;

	for (uint64_t id = 1; id <= 200; id++) {
		CHECK_INT(send_frame(stream, (uint8_t)id), id);
	}
	CHECK_INT(pursuit_poll_feedback(stream, &report), 0);
	struct pursuit_status status = status_of(stream);
	CHECK_INT(status.state, PURSUIT_STATE_DETACHED);
	CHECK_INT(status.submitted, 200);
	CHECK_INT(status.published, 0);
	CHECK(strstr(status.message, "no daemon at") && strstr(status.message, path));
	close_stream(&stream);
	CHECK_INT(open_files(), files);
}

static void test_too_many(void)
{
	struct pursuit_stream *stream = open_stream(5);
	struct pursuit_frame *frames[3];

	for (int i = 0; i < 3; i++) {
		frames[i] = timed_acquire(stream);
		CHECK(frames[i] != NULL);
	}
	CHECK(timed_acquire(stream) == NULL);
	CHECK_INT(status_of(stream).no_slot, 1);
	CHECK_INT(timed_submit(stream, NULL), 0);
	CHECK_INT(timed_submit(stream, frames[0] + 1000), 0);
	CHECK_INT(timed_submit(stream, frames[2]), 1);
	CHECK_INT(timed_submit(stream, frames[2]), 0);
	pursuit_cancel(stream, frames[2]);
	pursuit_cancel(stream, frames[1]);
	CHECK(timed_acquire(stream) != NULL);
	CHECK(timed_acquire(stream) != NULL);
	CHECK(timed_acquire(stream) == NULL);
	CHECK_INT(status_of(stream).submitted, 1);
	close_stream(&stream);
}

static void test_frames_arrive(void)
{
	struct fake_daemon daemon;
	const uint8_t *planes;
	CHECK(fake_start(&daemon, path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(4);

	CHECK(attach(stream, &daemon));
	CHECK(!daemon.bad_offer);
	CHECK_STRING(daemon.client_name, "a test");
	CHECK_NEAR(status_of(stream).refresh_hz, 119.88, 0.01);
	CHECK_INT(fake_wakes(&daemon), 0);
	for (uint8_t i = 1; i <= 100; i++) {
		uint64_t id = send_frame(stream, i);
		const struct pursuit_frame_header *header = fake_take(&daemon, &planes);
		CHECK(header && header->frame_id == id);
		CHECK(header && header->plane_count == 2 && planes[0] == i && planes[header->planes[1].offset] == i);
		CHECK_INT(fake_wakes(&daemon), 1);
		CHECK(fake_take(&daemon, NULL) == NULL);
	}
	CHECK_INT(status_of(stream).replaced, 0);
	CHECK_INT(status_of(stream).published, 100);
	close_stream(&stream);
	fake_stop(&daemon, true);
}

static void test_newest_wins(void)
{
	struct fake_daemon daemon;
	const uint8_t *planes;
	CHECK(fake_start(&daemon, path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(3);

	CHECK(attach(stream, &daemon));
	for (uint8_t i = 1; i <= 10; i++) {
		send_frame(stream, i);
	}
	const struct pursuit_frame_header *header = fake_take(&daemon, &planes);
	CHECK(header && header->frame_id == 10 && planes[0] == 10);
	CHECK_INT(status_of(stream).replaced, 9);
	CHECK_INT(status_of(stream).no_slot, 0);
	CHECK_INT(fake_wakes(&daemon), 10);
	/* What the daemon holds is not touched by the frames that follow. */
	for (uint8_t i = 11; i <= 20; i++) {
		send_frame(stream, i);
		CHECK_INT(planes[0], 10);
	}
	close_stream(&stream);
	fake_stop(&daemon, true);
}

static void test_header(void)
{
	struct fake_daemon daemon;
	CHECK(fake_start(&daemon, path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(4);
	CHECK(attach(stream, &daemon));

	struct pursuit_frame *frame = timed_acquire(stream);
	frame->time_ns = 5000;
	frame->flags = UINT32_MAX;
	frame->jitter_x = 0.25f;
	frame->view_projection[3] = 7.0f;
	frame->previous_view_projection[15] = 8.0f;
	frame->motion_interval_ns = 11;
	timed_submit(stream, frame);
	const struct pursuit_frame_header *header = fake_take(&daemon, NULL);
	CHECK_INT(header->flags,
			  PURSUIT_FRAME_CUT | PURSUIT_FRAME_MOTION_INVALID | PURSUIT_FRAME_MATRICES | PURSUIT_FRAME_JITTER);
	CHECK_INT(header->time_ns, 5000);
	CHECK_INT(header->real_interval_ns, 0);
	CHECK_INT(header->motion_interval_ns, 11);
	CHECK(header->submit_ns > 5000 && header->jitter_x == 0.25f);
	CHECK(header->view_projection[3] == 7.0f && header->previous_view_projection[15] == 8.0f);

	frame = timed_acquire(stream);
	CHECK(frame->view_projection[3] == 0.0f);
	frame->time_ns = 5300;
	frame->jitter_x = 0.25f;
	timed_submit(stream, frame);
	header = fake_take(&daemon, NULL);
	CHECK_INT(header->real_interval_ns, 300);
	CHECK(header->jitter_x == 0.0f && header->flags == 0 && header->motion_interval_ns == 0);

	frame = timed_acquire(stream);
	timed_submit(stream, frame);
	header = fake_take(&daemon, NULL);
	CHECK(header->time_ns > 5300 && header->time_ns <= header->submit_ns);
	frame = timed_acquire(stream);
	frame->time_ns = 100; /* back in time */
	timed_submit(stream, frame);
	CHECK_INT(fake_take(&daemon, NULL)->real_interval_ns, 0);
	frame = timed_acquire(stream);
	frame->time_ns = 200;
	frame->real_interval_ns = 16;
	timed_submit(stream, frame);
	CHECK_INT(fake_take(&daemon, NULL)->real_interval_ns, 16);
	close_stream(&stream);
	fake_stop(&daemon, true);
}

static void test_feedback(void)
{
	struct pursuit_feedback_report report;
	struct fake_daemon daemon;
	CHECK(fake_start(&daemon, path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(4);

	CHECK(attach(stream, &daemon));
	uint64_t id = send_frame(stream, 1);
	CHECK_INT(pursuit_poll_feedback(stream, &report), 0);
	fake_report(&daemon, id, PURSUIT_FEEDBACK_SHOWN);
	CHECK_INT(pursuit_poll_feedback(stream, &report), 1);
	CHECK_INT(report.frame_id, id);
	CHECK_INT(report.flip_ns, 1000 + id);
	CHECK_INT(pursuit_poll_feedback(stream, &report), 0);
	close_stream(&stream);
	fake_stop(&daemon, true);
}

static void test_refused(void)
{
	const enum fake_manner manners[] = {FAKE_REFUSES_VERSION, FAKE_REFUSES_STREAM};
	const char *const reasons[] = {"version 1 is  [31mtoo old", "too many streams"};

	for (int i = 0; i < 2; i++) {
		struct fake_daemon daemon;
		CHECK(fake_start(&daemon, path, manners[i]));
		int files = open_files();
		struct pursuit_stream *stream = open_stream(4);
		for (int k = 0; k < 50; k++) {
			fake_step(&daemon);
			send_frame(stream, 1);
			sleep_ms(1);
		}
		CHECK_INT(status_of(stream).state, PURSUIT_STATE_REFUSED);
		CHECK_STRING(status_of(stream).message, reasons[i]);
		CHECK_INT(daemon.accepts, 1);
		CHECK_INT(status_of(stream).submitted, 50);
		close_stream(&stream);
		fake_step(&daemon);
		CHECK_INT(open_files(), files);
		fake_stop(&daemon, true);
	}
}

/* A frame that was acquired from a daemon that is gone is memory until it is given back. */
static void test_frame_outlives_daemon(void)
{
	struct fake_daemon daemon;
	CHECK(fake_start(&daemon, path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(4);

	CHECK(attach(stream, &daemon));
	struct pursuit_frame *kept = timed_acquire(stream);
	fake_stop(&daemon, true);
	struct pursuit_frame *plain = timed_acquire(stream);
	CHECK_INT(status_of(stream).state, PURSUIT_STATE_DETACHED);
	CHECK(plain && kept && plain->color.data != kept->color.data);
	CHECK(timed_acquire(stream) == NULL);
	memset(kept->color.data, 1, kept->color.stride * kept->color.height);

	CHECK(fake_start(&daemon, path, FAKE_GOOD));
	CHECK(attach(stream, &daemon));
	CHECK_INT(status_of(stream).attaches, 2);
	CHECK(timed_acquire(stream) == NULL);
	memset(kept->color.data, 2, kept->color.stride * kept->color.height);
	memset(plain->color.data, 2, plain->color.stride * plain->color.height);
	CHECK_INT(timed_submit(stream, kept), 1);
	CHECK_INT(timed_submit(stream, kept), 0);
	struct pursuit_frame *fresh = timed_acquire(stream);
	CHECK(fresh && fresh->color.data != plain->color.data);
	pursuit_cancel(stream, plain);
	CHECK_INT(timed_submit(stream, fresh), 2);
	CHECK_INT(status_of(stream).published, 1);
	const struct pursuit_frame_header *header = fake_take(&daemon, NULL);
	CHECK(header && header->frame_id == 2);
	close_stream(&stream);
	fake_stop(&daemon, true);
}

static void test_closed_with_frames_out(void)
{
	struct fake_daemon daemon;
	CHECK(fake_start(&daemon, path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(5);

	CHECK(attach(stream, &daemon));
	timed_acquire(stream);
	fake_stop(&daemon, true);
	pursuit_update(stream);
	timed_acquire(stream);
	close_stream(&stream);
}

/* Submits at 60 a second until `state`; the milliseconds it took. */
static uint64_t submit_until(struct pursuit_stream *stream, enum pursuit_state state)
{
	uint64_t begin = now();
	while (status_of(stream).state != state && now() - begin < 3000 * MS) {
		send_frame(stream, 1);
		sleep_ms(16);
	}
	return (now() - begin) / MS;
}

static void test_killed_and_back(void)
{
	pid_t child = fake_fork(path);
	CHECK(child > 0);
	struct pursuit_stream *stream = open_stream(4);

	for (int round = 1; round <= 3; round++) {
		uint64_t took = submit_until(stream, PURSUIT_STATE_ATTACHED);
		CHECK(took < 1000);
		printf("       attached after %llu ms\n", (unsigned long long)took);
		for (int i = 0; i < 20; i++) {
			send_frame(stream, 1);
			sleep_ms(2);
		}
		struct pursuit_feedback_report report;
		CHECK_INT(pursuit_poll_feedback(stream, &report), 1);
		kill(child, SIGKILL);
		waitpid(child, NULL, 0);
		send_frame(stream, 1);
		CHECK(status_of(stream).state != PURSUIT_STATE_ATTACHED);
		for (int i = 0; i < 20; i++) {
			CHECK(send_frame(stream, 1) > 0);
			sleep_ms(2);
		}
		CHECK_INT(status_of(stream).attaches, round);
		child = fake_fork(path);
		CHECK(child > 0);
	}
	kill(child, SIGKILL);
	waitpid(child, NULL, 0);
	close_stream(&stream);
}

/* Stopped, a daemon is as silent as one that hangs: frames replace each other. */
static void test_stopped(void)
{
	pid_t child = fake_fork(path);
	CHECK(child > 0);
	struct pursuit_stream *stream = open_stream(4);

	submit_until(stream, PURSUIT_STATE_ATTACHED);
	kill(child, SIGSTOP);
	sleep_ms(5);
	uint64_t before = status_of(stream).replaced;
	for (int i = 0; i < 500; i++) {
		CHECK(send_frame(stream, 1) > 0);
	}
	CHECK(status_of(stream).replaced - before >= 498);
	CHECK_INT(status_of(stream).no_slot, 0);
	kill(child, SIGKILL);
	waitpid(child, NULL, 0);
	close_stream(&stream);
}

static void test_no_answer(void)
{
	const enum fake_manner manners[] = {FAKE_SILENT, FAKE_NOT_ACCEPTING};

	for (int i = 0; i < 2; i++) {
		struct fake_daemon daemon;
		CHECK(fake_start(&daemon, path, manners[i]));
		/* More streams than the backlog of the second holds: its socket is full. */
		int count = manners[i] == FAKE_SILENT ? 1 : 4;
		struct pursuit_stream *streams[4];
		for (int k = 0; k < count; k++) {
			streams[k] = open_stream(4);
		}
		for (int k = 0; k < 200; k++) {
			fake_step(&daemon);
			CHECK(send_frame(streams[k % count], 1) > 0);
			sleep_ms(k % 4 == 0);
		}
		CHECK_INT(status_of(streams[0]).state, PURSUIT_STATE_ATTACHING);
		if (manners[i] == FAKE_NOT_ACCEPTING) {
			CHECK_INT(status_of(streams[3]).state, PURSUIT_STATE_DETACHED);
		}
		for (int k = 0; k < count; k++) {
			close_stream(&streams[k]);
		}
		fake_stop(&daemon, true);
	}
}

static void test_nonsense(void)
{
	for (int manner = FAKE_SHORT_PACKET; manner < FAKE_MANNERS; manner++) {
		struct fake_daemon daemon;
		CHECK(fake_start(&daemon, path, (enum fake_manner)manner));
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
		} else if (status.state == PURSUIT_STATE_ATTACHED && manner != FAKE_FLOOD) {
			test_state.failed++;
			fprintf(stderr, "attached to nonsense %d\n", manner);
		}
		printf("       nonsense %2d: %s\n", manner, status.message);
		close_stream(&stream);
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
	CHECK(fake_start(&daemon, path, FAKE_BLOCKING_FULL_WAKE));
	struct pursuit_stream *stream = open_stream(4);

	CHECK(attach(stream, &daemon));
	CHECK(fcntl(daemon.wake, F_GETFL) & O_NONBLOCK);
	CHECK_INT(fcntl(daemon.wake, F_SETFL, 0), 0);
	CHECK_INT(write(daemon.wake, &full, sizeof(full)), sizeof(full));
	for (int i = 0; i < 10; i++) {
		CHECK(send_frame(stream, 1) > 0);
	}
	CHECK_INT(status_of(stream).published, 10);
	close_stream(&stream);
	fake_stop(&daemon, true);
}

/* The daemon writes into the shared word what it may not. */
static void test_broken_word(void)
{
	struct fake_daemon daemon;
	CHECK(fake_start(&daemon, path, FAKE_GOOD));
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
	close_stream(&stream);
	fake_stop(&daemon, true);
}

/* Out of file descriptors at each step of the way; attached once there are some again. */
static void test_no_descriptors(void)
{
	struct rlimit old, small;
	CHECK_INT(getrlimit(RLIMIT_NOFILE, &old), 0);

	for (rlim_t spare = 0; spare < 5; spare++) {
		pid_t child = fake_fork(path);
		int lowest = dup(0);
		close(lowest);
		small = (struct rlimit){.rlim_cur = (rlim_t)lowest + spare, .rlim_max = old.rlim_max};
		CHECK_INT(setrlimit(RLIMIT_NOFILE, &small), 0);
		struct pursuit_stream *stream = open_stream(4);
		for (int i = 0; i < 30; i++) {
			CHECK(send_frame(stream, 1) > 0);
			sleep_ms(2);
		}
		struct pursuit_status status = status_of(stream);
		CHECK_INT(status.state == PURSUIT_STATE_ATTACHED, spare >= 3);
		CHECK_INT(setrlimit(RLIMIT_NOFILE, &old), 0);
		printf("       %llu descriptors: %s\n", (unsigned long long)spare, status.message);
		submit_until(stream, PURSUIT_STATE_ATTACHED);
		CHECK_INT(status_of(stream).state, PURSUIT_STATE_ATTACHED);
		close_stream(&stream);
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
	CHECK(fake_start(&daemon, path, FAKE_GOOD));
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
	close_stream(&stream);
	fake_stop(&daemon, true);
}

/* Where a stream looks when it is not told: the first of two places, then the second. */
static void test_environment(void)
{
	struct pursuit_stream_params params = {.width = 16, .height = 16};
	struct fake_daemon daemon;
	char runtime[96];

	snprintf(runtime, sizeof(runtime), "%s/pursuit", folder);
	CHECK_INT(mkdir(runtime, 0700), 0);
	snprintf(runtime, sizeof(runtime), "%s/pursuit/socket", folder);
	unsetenv("PURSUIT_SOCKET");
	setenv("XDG_RUNTIME_DIR", folder, 1);
	CHECK(fake_start(&daemon, runtime, FAKE_GOOD));
	struct pursuit_stream *stream = pursuit_open(&params);
	CHECK(attach(stream, &daemon));
	CHECK_STRING(daemon.client_name, "test_attach");
	fake_stop(&daemon, true);
	sleep_ms(30);
	pursuit_update(stream);
	sleep_ms(30);
	pursuit_update(stream);
	CHECK(strstr(status_of(stream).message, "/run/pursuit/socket"));
	close_stream(&stream);

	setenv("PURSUIT_SOCKET", path, 1);
	CHECK(fake_start(&daemon, path, FAKE_GOOD));
	stream = pursuit_open(&params);
	CHECK(attach(stream, &daemon));
	close_stream(&stream);
	fake_stop(&daemon, true);
	unlink(runtime);
	snprintf(runtime, sizeof(runtime), "%s/pursuit", folder);
	rmdir(runtime);
}

int main(void)
{
	if (!mkdtemp(folder)) {
		perror(folder);
		return 1;
	}
	snprintf(path, sizeof(path), "%s/socket", folder);
	RUN(test_parameters);
	RUN(test_null);
	RUN(test_no_daemon);
	RUN(test_too_many);
	RUN(test_frames_arrive);
	RUN(test_newest_wins);
	RUN(test_header);
	RUN(test_feedback);
	RUN(test_refused);
	RUN(test_frame_outlives_daemon);
	RUN(test_closed_with_frames_out);
	RUN(test_killed_and_back);
	RUN(test_stopped);
	RUN(test_no_answer);
	RUN(test_nonsense);
	RUN(test_wake_is_filled);
	RUN(test_broken_word);
	RUN(test_no_descriptors);
	RUN(test_signals);
	RUN(test_environment);
	unlink(path);
	rmdir(folder);
	return test_result();
}
