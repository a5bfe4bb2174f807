/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Processes that are suspended for a while (SIGSTOP) and go on: the daemon under a running game, and the client that
 * is shown. To the one that wakes up, all clocks have jumped. Three seconds in ./check, as long as one likes by hand.
 *
 *   test-suspend PURSUITD [SECONDS]
 */

#include <jansson.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"
#include "tests/fault/game.h"

static struct fixture fixture;
static unsigned seconds = 3;

/* Reports read now that say "shown" of frames submitted after a time. */
static unsigned count_shown(struct pursuit_stream *stream, uint64_t after_ns)
{
	struct pursuit_feedback_report report;
	unsigned shown = 0;
	while (pursuit_poll_feedback(stream, &report))
		shown += report.shown == PURSUIT_SHOWN && report.submit_ns > after_ns;
	return shown;
}

/* Plays until so many frames submitted from now on were shown, 60 s at most. The time it took, ns. */
static uint64_t play_until_shown(struct pursuit_stream *stream, unsigned wanted)
{
	const uint64_t start = now_ns();
	unsigned shown = 0;
	for (int i = 0; i < 3750 && shown < wanted; i++) {
		game_play_frame(stream);
		shown += count_shown(stream, start);
	}
	CHECK(shown >= wanted);
	return now_ns() - start;
}

static json_int_t figure(const char *name)
{
	const int fd = raw_greet(fixture.socket);
	const json_int_t value = question_figure(fd, "status", name);
	close(fd);
	return value;
}

/* The game renders on as if nothing were, is attached all the while, and is shown again soon. */
static void test_daemon_suspended(void)
{
	uint64_t longest_ns = 0, quick = 0, calls = 0;
	fixture_start(&fixture, NULL);
	struct pursuit_stream *stream = game_open(fixture.socket);
	CHECK(stream != NULL);
	play_until_shown(stream, 5);
	kill(fixture.pid, SIGSTOP);
	for (const uint64_t end = now_ns() + seconds * UINT64_C(1000000000); now_ns() < end; calls++) {
		const uint64_t taken = game_play_frame(stream);
		longest_ns = taken > longest_ns ? taken : longest_ns;
		quick += taken < GAME_FRAME_MS * UINT64_C(1000000);
		CHECK(game_is_attached(stream));
	}
	kill(fixture.pid, SIGCONT);
	const uint64_t back_ns = play_until_shown(stream, 1);
	printf("       daemon suspended for %u s: %llu frames rendered, longest call %.3f ms; shown again after %.0f ms\n",
		   seconds, (unsigned long long)calls, (double)longest_ns / 1e6, (double)back_ns / 1e6);
	/* The machine may be busy, but not in most calls. */
	CHECK(quick > calls / 2);
	play_until_shown(stream, 30);
	CHECK(game_is_attached(stream));
	CHECK_INT(figure("streams"), 1);
	CHECK_INT(figure("engine_losses"), 0);
	CHECK_INT(figure("refused_frames"), 0);
	pursuit_close(&stream);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

static void focus(pid_t pid)
{
	const int fd = raw_greet(fixture.socket);
	json_t *status = question_ask(fd, "status"), *streams = json_object_get(status, "streams");
	char request[64] = "";
	for (size_t i = 0; i < json_array_size(streams); i++) {
		const json_t *stream = json_array_get(streams, i);
		if (json_integer_value(json_object_get(stream, "pid")) == pid)
			snprintf(request, sizeof(request), "set focus=%d",
					 (int)json_integer_value(json_object_get(stream, "client_id")));
	}
	json_decref(status);
	json_decref(question_ask(fd, request));
	close(fd);
}

static pid_t start_client(void)
{
	fflush(stdout);
	const pid_t child = fork();
	if (child != 0)
		return child;
	struct pursuit_stream *stream = game_open(fixture.socket);
	CHECK(stream != NULL);
	for (;;)
		game_play_frame(stream);
}

static bool wait_for_streams(json_int_t wanted)
{
	json_int_t streams = -1;
	for (unsigned waited = 0; waited < PATIENCE_MS && streams != wanted; waited += 10) {
		streams = figure("streams");
		sleep_ms(10);
	}
	return streams == wanted;
}

/* It keeps its stream and nobody else; who is focused meanwhile is shown; it goes on where it was. */
static void test_client_suspended(void)
{
	fixture_start(&fixture, NULL);
	struct pursuit_stream *stream = game_open(fixture.socket);
	CHECK(stream != NULL);
	play_until_shown(stream, 3);
	const pid_t child = start_client();
	CHECK(wait_for_streams(2));
	kill(child, SIGSTOP);
	const uint64_t end = now_ns() + seconds * UINT64_C(1000000000);
	focus(getpid());
	const uint64_t shown_ns = play_until_shown(stream, 1);
	while (now_ns() < end)
		game_play_frame(stream);
	play_until_shown(stream, 10);
	CHECK_INT(figure("streams"), 2);
	printf("       client suspended for %u s: another one is shown %.0f ms after it is chosen\n", seconds,
		   (double)shown_ns / 1e6);
	const json_int_t received = figure("received_frames");
	kill(child, SIGCONT);
	focus(child);
	for (unsigned waited = 0; waited < PATIENCE_MS && figure("received_frames") < received + 5; waited += 20)
		sleep_ms(20);
	CHECK(figure("received_frames") >= received + 5);
	kill(child, SIGKILL);
	waitpid(child, NULL, 0);
	CHECK(wait_for_streams(1));
	play_until_shown(stream, 3);
	pursuit_close(&stream);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

int main(int argc, char **argv)
{
	if (argc < 2)
		return 2;
	seconds = argc > 2 ? (unsigned)atoi(argv[2]) : seconds;
	fixture_init(&fixture, argv[1]);
	RUN(test_daemon_suspended);
	RUN(test_client_suspended);
	fixture_finish(&fixture);
	return test_result();
}
