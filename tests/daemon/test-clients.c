/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Several clients at once: which one is shown, who is told so, whose are the keys. */

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/raw-client.h"

#define WIDTH 64u
#define HEIGHT 48u
#define PATIENCE 2400 /* turns of 25 ms */

static struct fixture fixture;

static struct pursuit_stream *open_stream(const char *name, int wants_keys)
{
	const struct pursuit_stream_params params = {.width = WIDTH,
												 .height = HEIGHT,
												 .depth_format = PURSUIT_DEPTH_FLOAT32,
												 .motion_format = PURSUIT_MOTION_FLOAT32,
												 .socket_path = fixture.socket,
												 .name = name,
												 .wants_keys = wants_keys};
	return pursuit_open(&params);
}

static void submit(struct pursuit_stream *stream)
{
	struct pursuit_frame *frame = pursuit_acquire(stream);
	if (frame)
		pursuit_submit(stream, frame);
}

static bool is_background(struct pursuit_stream *stream)
{
	struct pursuit_status status;
	pursuit_get_status(stream, &status);
	return status.background != 0;
}

static bool is_attached(struct pursuit_stream *stream)
{
	struct pursuit_status status;
	pursuit_get_status(stream, &status);
	return status.state == PURSUIT_STATE_ATTACHED;
}

static uint64_t count_shown(struct pursuit_stream *stream)
{
	struct pursuit_feedback_report report;
	uint64_t shown = 0;
	while (pursuit_poll_feedback(stream, &report))
		shown += report.shown == PURSUIT_SHOWN;
	return shown;
}

/* Both play until `one` is shown and the other one is in the background. */
static bool play_until_shown(struct pursuit_stream *one, struct pursuit_stream *other)
{
	uint64_t shown = 0;
	count_shown(one);
	for (int i = 0; i < PATIENCE; i++) {
		submit(one);
		submit(other);
		sleep_ms(25);
		shown += is_attached(one) && !is_background(one) ? count_shown(one) : 0;
		if (shown >= 3 && is_background(other))
			return true;
	}
	return false;
}

static int ask(const char *request)
{
	static struct raw_reply reply;
	const int fd = raw_greet(fixture.socket), status = raw_control(fd, request, -1, &reply);
	close(fd);
	return status;
}

static bool next_key(struct pursuit_stream *stream, struct pursuit_key *key)
{
	for (int i = 0; i < PATIENCE; i++) {
		if (pursuit_next_key(stream, key))
			return true;
		sleep_ms(25);
	}
	return false;
}

static void test_focus(void)
{
	struct pursuit_stream *a = open_stream("game a", 0), *b;
	struct pursuit_key key;
	for (int i = 0; i < PATIENCE && !is_attached(a); i++) {
		submit(a);
		sleep_ms(25);
	}
	CHECK(is_attached(a));
	b = open_stream("game b", 1);
	CHECK(play_until_shown(b, a)); /* the newest */

	CHECK_INT(ask("set focus=game a"), 0);
	CHECK(play_until_shown(a, b));
	CHECK_INT(ask("set focus=nobody"), ENOENT);
	CHECK(play_until_shown(a, b));

	/* Keys are for the one that is shown, if it wants them. */
	CHECK_INT(ask("key o"), 0);
	CHECK_INT(ask("set focus=game b"), 0);
	CHECK(play_until_shown(b, a));
	CHECK_INT(ask("key c"), 0);
	CHECK(next_key(b, &key));
	CHECK_INT(key.code, 'c');
	CHECK(key.time_ns > 0 && key.time_ns <= now_ns());
	CHECK_INT(pursuit_next_key(a, &key), 0);

	pursuit_close(&b);
	for (int i = 0; i < PATIENCE && is_background(a); i++)
		sleep_ms(25);
	CHECK(!is_background(a)); /* what is left is shown */
	pursuit_close(&a);
}

static void test_quit_key(void)
{
	struct pursuit_stream *stream = open_stream("game", 1);
	struct pursuit_key key;
	for (int i = 0; i < PATIENCE && !is_attached(stream); i++) {
		submit(stream);
		sleep_ms(25);
	}
	CHECK_INT(ask("key Q!"), EINVAL);
	CHECK_INT(ask("key q"), 0);
	CHECK(next_key(stream, &key)); /* the client first */
	CHECK_INT(key.code, 'q');
	CHECK_INT(ask("key escape"), 0);
	CHECK_INT(fixture_join(&fixture), 0); /* it has not ended, so the daemon does */
	pursuit_close(&stream);
}

static bool has_stream(void)
{
	static struct raw_reply reply;
	const int fd = raw_greet(fixture.socket);
	CHECK_INT(raw_control(fd, "status", -1, &reply), 0);
	close(fd);
	return strstr((const char *)reply.raw + sizeof(reply.control), "a parent") != NULL;
}

/* One that dies, and leaves a child that has all that it had. */
static void test_parent_that_dies(void)
{
	int ends[2], child = 0;
	CHECK_INT(pipe(ends), 0);
	const pid_t parent = fork();
	if (parent == 0) {
		struct pursuit_stream *stream = open_stream("a parent", 0);
		for (int i = 0; i < PATIENCE && !is_attached(stream); i++) {
			submit(stream);
			sleep_ms(25);
		}
		child = fork();
		if (child == 0)
			for (;;)
				pause();
		CHECK(write(ends[1], &child, sizeof(child)) == sizeof(child));
		for (;;)
			pause();
	}
	CHECK(read(ends[0], &child, sizeof(child)) == sizeof(child));
	CHECK(has_stream());
	kill(parent, SIGKILL);
	waitpid(parent, NULL, 0);
	bool has = true;
	for (int i = 0; i < PATIENCE && has; i++) {
		sleep_ms(25);
		has = has_stream();
	}
	CHECK(!has);
	CHECK_INT(kill(child, 0), 0);
	kill(child, SIGKILL);
	close(ends[0]);
	close(ends[1]);
}

int main(int argc, char **argv)
{
	(void)argc;
	fixture_init(&fixture, argv[1]);
	fixture_start(&fixture, NULL);
	RUN(test_focus);
	RUN(test_parent_that_dies);
	RUN(test_quit_key);
	fixture_finish(&fixture);
	return test_result();
}
