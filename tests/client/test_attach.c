/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The stream with no daemon, a good one, and one that is killed and comes back. */

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/attach.h"
#include "tests/client/harness.h"
#include "tests/test.h"

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
	unlink(harness.path);
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
	CHECK(strstr(status.message, "no daemon at") && strstr(status.message, harness.path));
	CHECK(close_stream(&stream));
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
	CHECK(close_stream(&stream));
}

static void test_frames_arrive(void)
{
	struct fake_daemon daemon;
	const uint8_t *planes;
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
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
	CHECK(close_stream(&stream));
	fake_stop(&daemon, true);
}

static void test_newest_wins(void)
{
	struct fake_daemon daemon;
	const uint8_t *planes;
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
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
	CHECK(close_stream(&stream));
	fake_stop(&daemon, true);
}

static void test_header(void)
{
	struct fake_daemon daemon;
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
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
	frame->flags = PURSUIT_FLAG_DAMAGE;
	frame->damage_count = 1;
	frame->damage[0] = (struct pursuit_damage){1, 2, 3, 4};
	const uint64_t before = header->frame_id;
	timed_submit(stream, frame);
	header = fake_take(&daemon, NULL);
	CHECK(header->flags == PURSUIT_FRAME_DAMAGE && header->damage_since == before && header->damage_count == 1);
	CHECK(header->damage[0].y == 2 && header->damage[0].height == 4 && header->damage[1].width == 0);
	frame = timed_acquire(stream);
	CHECK(frame->damage_count == 0);
	frame->flags = PURSUIT_FLAG_DAMAGE;
	frame->damage_count = 9;
	timed_submit(stream, frame);
	header = fake_take(&daemon, NULL);
	CHECK(header->flags == 0 && header->damage_since == 0 && header->damage_count == 0);

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
	CHECK(close_stream(&stream));
	fake_stop(&daemon, true);
}

static void test_feedback(void)
{
	struct pursuit_feedback_report report;
	struct fake_daemon daemon;
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(4);

	CHECK(attach(stream, &daemon));
	uint64_t id = send_frame(stream, 1);
	CHECK_INT(pursuit_poll_feedback(stream, &report), 0);
	fake_report(&daemon, id, PURSUIT_FEEDBACK_SHOWN);
	CHECK_INT(pursuit_poll_feedback(stream, &report), 1);
	CHECK_INT(report.frame_id, id);
	CHECK_INT(report.flip_ns, 1000 + id);
	CHECK_INT(pursuit_poll_feedback(stream, &report), 0);
	fake_stop(&daemon, true);
	pursuit_update(stream);
	CHECK_INT(pursuit_poll_feedback(stream, &report), 0);

	/* The ring of the next daemon begins anew. */
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
	CHECK(attach(stream, &daemon));
	fake_report(&daemon, 7, PURSUIT_FEEDBACK_REPLACED);
	CHECK_INT(pursuit_poll_feedback(stream, &report), 1);
	CHECK_INT(report.frame_id, 7);
	CHECK(close_stream(&stream));
	fake_stop(&daemon, true);
}

/* An attached stream that the daemon ends: with a reason, without one, and because it stops. */
static void test_ended(void)
{
	const enum pursuit_state states[] = {PURSUIT_STATE_REFUSED, PURSUIT_STATE_DETACHED, PURSUIT_STATE_DETACHED};
	const char *const messages[] = {"near_distance is -1", "the daemon closed the stream", "the daemon is stopping"};

	for (int i = 0; i < 3; i++) {
		struct fake_daemon daemon;
		CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
		struct pursuit_stream *stream = open_stream(4);
		CHECK(attach(stream, &daemon));
		send_frame(stream, 1);
		if (i < 2) {
			fake_close_stream(&daemon, i == 0 ? messages[0] : NULL);
		} else {
			fake_say_shutdown(&daemon);
		}
		const uint64_t begin = now();
		pursuit_update(stream);
		CHECK_INT(status_of(stream).state, states[i]);
		CHECK_STRING(status_of(stream).message, messages[i]);
		/* Only a daemon that stops is asked again before a second is over. */
		for (int k = 0; k < (i == 2 ? 10000 : 3) && status_of(stream).state != PURSUIT_STATE_ATTACHING; k++) {
			sleep_ms(6);
			pursuit_update(stream);
		}
		CHECK(status_of(stream).state == PURSUIT_STATE_ATTACHING ? i == 2 || now() - begin >= 1000 * MS : i != 2);
		CHECK(send_frame(stream, 1) > 0);
		CHECK(close_stream(&stream));
		fake_stop(&daemon, true);
	}
}

/* A frame that was acquired from a daemon that is gone is memory until it is given back. */
static void test_frame_outlives_daemon(void)
{
	struct fake_daemon daemon;
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(4);

	CHECK(attach(stream, &daemon));
	struct pursuit_frame *kept = timed_acquire(stream);
	fake_stop(&daemon, true);
	struct pursuit_frame *plain = timed_acquire(stream);
	CHECK_INT(status_of(stream).state, PURSUIT_STATE_DETACHED);
	CHECK(plain && kept && plain->color.data != kept->color.data);
	CHECK(timed_acquire(stream) == NULL);
	memset(kept->color.data, 1, kept->color.stride * kept->color.height);

	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
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
	CHECK(close_stream(&stream));
	fake_stop(&daemon, true);
}

static void test_closed_with_frames_out(void)
{
	struct fake_daemon daemon;
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(5);

	CHECK(attach(stream, &daemon));
	timed_acquire(stream);
	fake_stop(&daemon, true);
	pursuit_update(stream);
	timed_acquire(stream);
	CHECK(close_stream(&stream));
}

static bool submit_until_reported(struct pursuit_stream *stream)
{
	struct pursuit_feedback_report report;
	const uint64_t end = now() + PATIENCE_NS;
	bool reported = false;
	while (!reported && now() < end) {
		send_frame(stream, 1);
		sleep_ms(2);
		reported = pursuit_poll_feedback(stream, &report);
	}
	return reported;
}

static void test_killed_and_back(void)
{
	pid_t child = fake_fork(harness.path);
	CHECK(child > 0);
	struct pursuit_stream *stream = open_stream(4);

	for (int round = 1; round <= 3; round++) {
		CHECK(submit_until(stream, PURSUIT_STATE_ATTACHED));
		CHECK(submit_until_reported(stream));
		kill(child, SIGKILL);
		waitpid(child, NULL, 0);
		send_frame(stream, 1);
		CHECK(status_of(stream).state != PURSUIT_STATE_ATTACHED);
		for (int i = 0; i < 20; i++) {
			CHECK(send_frame(stream, 1) > 0);
			sleep_ms(2);
		}
		CHECK_INT(status_of(stream).attaches, round);
		child = fake_fork(harness.path);
		CHECK(child > 0);
	}
	kill(child, SIGKILL);
	waitpid(child, NULL, 0);
	CHECK(close_stream(&stream));
}

static void hear(int pipe)
{
	char byte;
	CHECK(read(pipe, &byte, 1) == 1);
}

/* A child that has a copy of everything and uses it; ends with 0 if all is well. */
static int play_child(struct pursuit_stream *stream, int heard, int said)
{
	struct pursuit_status status = status_of(stream);
	if (status.state != PURSUIT_STATE_ATTACHED || send_frame(stream, 9) == 0) {
		return 1;
	}
	status = status_of(stream);
	if (status.state == PURSUIT_STATE_ATTACHED || status.published != 1) {
		return 2;
	}
	pursuit_update(stream);
	if (status_of(stream).state != PURSUIT_STATE_ATTACHING) {
		return 3;
	}
	pursuit_close(&stream);
	char byte = 1;
	return write(said, &byte, 1) == 1 && read(heard, &byte, 1) == 0 ? 0 : 4; /* lives on meanwhile */
}

/* The connection has ended, though its other end is open. */
static bool is_hung_up(const struct fake_daemon *daemon)
{
	struct pollfd client = {daemon->client, POLLIN, 0};
	return poll(&client, 1, 0) == 1 && (client.revents & POLLHUP);
}

/* fork() without exec(): the stream stays the parent's whatever the child does, and goes with the parent. */
static void test_forked(void)
{
	struct fake_daemon daemon;
	int to_child[2], to_parent[2], status = -1;

	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
	struct pursuit_stream *stream = open_stream(4);
	CHECK(attach(stream, &daemon));
	CHECK_INT(send_frame(stream, 1), 1);
	CHECK(fake_take(&daemon, NULL) != NULL);
	const pid_t idle = fork();
	if (idle == 0) {
		pause();
		_exit(0);
	}
	CHECK(pipe(to_child) == 0 && pipe(to_parent) == 0);
	const pid_t child = fork();
	if (child == 0) {
		close(to_parent[0]);
		close(to_child[1]);
		_exit(play_child(stream, to_child[0], to_parent[1]));
	}
	close(to_child[0]);
	close(to_parent[1]); /* a child that fails is the end of it */
	hear(to_parent[0]);
	CHECK(fake_take(&daemon, NULL) == NULL);
	CHECK(!is_hung_up(&daemon));
	CHECK_INT(send_frame(stream, 2), 2);
	CHECK_INT(status_of(stream).state, PURSUIT_STATE_ATTACHED);
	const struct pursuit_frame_header *header = fake_take(&daemon, NULL);
	CHECK(header && header->frame_id == 2);
	CHECK(close_stream(&stream));
	CHECK(is_hung_up(&daemon));
	close(to_child[1]);
	CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status));
	CHECK_INT(WEXITSTATUS(status), 0);
	kill(idle, SIGKILL);
	waitpid(idle, NULL, 0);
	close(to_parent[0]);
	fake_stop(&daemon, true);
}

/* Where a stream looks when it is not told: the first of two places, then the second. */
static void test_second_place(void)
{
	const struct pursuit_stream_params params = {.width = 16, .height = 16};
	struct fake_daemon gone, daemon;
	struct shim_layout layout;
	struct shim_attach attach;

	CHECK(shim_layout_init(&layout, &params));
	CHECK(shim_attach_init(&attach, NULL, NULL));
	attach.path_count = 2;
	snprintf(attach.paths[0], SHIM_PATH_BYTES, "%s-gone", harness.path);
	snprintf(attach.paths[1], SHIM_PATH_BYTES, "%s", harness.path);
	/* One that has ended leaves its socket behind, where nobody answers. */
	CHECK(fake_start(&gone, attach.paths[0], FAKE_GOOD));
	fake_stop(&gone, false);
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
	shim_attach_step(&attach, &layout, 0);
	CHECK_INT(attach.state, PURSUIT_STATE_ATTACHING);
	CHECK_INT(strlen(strstr(attach.message, harness.path)), strlen(harness.path));
	shim_attach_finish(&attach);
	fake_stop(&daemon, true);
	unlink(attach.paths[0]);
}

static void test_environment(void)
{
	struct pursuit_stream_params params = {.width = 16, .height = 16};
	struct fake_daemon daemon;
	char runtime[96];

	snprintf(runtime, sizeof(runtime), "%s/pursuit", harness.folder);
	CHECK_INT(mkdir(runtime, 0700), 0);
	snprintf(runtime, sizeof(runtime), "%s/pursuit/socket", harness.folder);
	unsetenv("PURSUIT_SOCKET");
	setenv("XDG_RUNTIME_DIR", harness.folder, 1);
	CHECK(fake_start(&daemon, runtime, FAKE_GOOD));
	struct pursuit_stream *stream = pursuit_open(&params);
	CHECK(attach(stream, &daemon));
	CHECK_STRING(daemon.client_name, "test_attach");
	fake_stop(&daemon, true);
	sleep_ms(30);
	pursuit_update(stream);
	sleep_ms(30);
	pursuit_update(stream);
	CHECK(strstr(status_of(stream).message, runtime));
	unlink(runtime);
	sleep_ms(30);
	pursuit_update(stream);
	CHECK(strstr(status_of(stream).message, runtime));
	CHECK(close_stream(&stream));

	setenv("PURSUIT_SOCKET", harness.path, 1);
	CHECK(fake_start(&daemon, harness.path, FAKE_GOOD));
	stream = pursuit_open(&params);
	CHECK(attach(stream, &daemon));
	CHECK(close_stream(&stream));
	fake_stop(&daemon, true);
	unlink(runtime);
	snprintf(runtime, sizeof(runtime), "%s/pursuit", harness.folder);
	rmdir(runtime);
}

int main(void)
{
	if (!harness_start()) {
		return 1;
	}
	RUN(test_parameters);
	RUN(test_null);
	RUN(test_no_daemon);
	RUN(test_too_many);
	RUN(test_frames_arrive);
	RUN(test_newest_wins);
	RUN(test_header);
	RUN(test_feedback);
	RUN(test_ended);
	RUN(test_frame_outlives_daemon);
	RUN(test_closed_with_frames_out);
	RUN(test_killed_and_back);
	RUN(test_forked);
	RUN(test_second_place);
	RUN(test_environment);
	harness_finish();
	return test_result();
}
