/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Things that end in the middle: the daemon by kill -9 under a running game,
 * clients at any instruction, a client that stands still. What
 * is left goes on. Times are told, not judged, but for the coarsest.
 *
 *   test-recovery PURSUITD [KILLS]
 */

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"
#include "tests/fault/game.h"

#define ROUNDS 5
#define MOST_STEPS 4000u

static struct fixture fixture;
static unsigned kills = 40;

/* ---- a game ---- */

/* Plays until attached, 60 s at most; the longest time in the shim goes into *longest_ns. */
static bool play_until_attached(struct pursuit_stream *stream, uint64_t *longest_ns)
{
	for (int i = 0; i < 3750 && !game_is_attached(stream); i++) {
		const uint64_t taken = game_play_frame(stream);
		*longest_ns = taken > *longest_ns ? taken : *longest_ns;
	}
	return game_is_attached(stream);
}

static int by_size(const void *a, const void *b)
{
	const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return x < y ? -1 : x > y;
}

static void test_daemon_killed(void)
{
	uint64_t back_ns[ROUNDS], longest_ns[ROUNDS] = {0};
	fixture_start(&fixture, NULL);
	struct pursuit_stream *stream = game_open(fixture.socket);
	CHECK(stream != NULL);
	CHECK(play_until_attached(stream, &longest_ns[0]));
	for (int round = 0; round < ROUNDS; round++) {
		longest_ns[round] = 0;
		for (int i = 0; i < 5; i++)
			game_play_frame(stream);
		CHECK_INT(fixture_stop(&fixture, SIGKILL), 128 + SIGKILL);
		for (int i = 0; i < 10; i++) {
			const uint64_t taken = game_play_frame(stream);
			longest_ns[round] = taken > longest_ns[round] ? taken : longest_ns[round];
		}
		CHECK(!game_is_attached(stream));
		fixture_start(&fixture, NULL);
		const uint64_t start = now_ns();
		CHECK(play_until_attached(stream, &longest_ns[round]));
		back_ns[round] = now_ns() - start;
	}
	qsort(back_ns, ROUNDS, sizeof(back_ns[0]), by_size);
	qsort(longest_ns, ROUNDS, sizeof(longest_ns[0]), by_size);
	printf("       daemon killed %d times: attached again after %.0f ms (longest %.0f), longest call %.3f ms (%.3f)\n",
		   ROUNDS, (double)back_ns[ROUNDS / 2] / 1e6, (double)back_ns[ROUNDS - 1] / 1e6,
		   (double)longest_ns[ROUNDS / 2] / 1e6, (double)longest_ns[ROUNDS - 1] / 1e6);
	/* The machine may be busy, but not in all rounds alike. */
	CHECK(longest_ns[0] < GAME_FRAME_MS * 1000000u);
	pursuit_close(&stream);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

/* ---- clients that end, or stand still ---- */

static struct {
	pthread_t thread;
	atomic_bool stop;
	_Atomic uint64_t shown, failed;
} neighbour;

/* Each of its frames is answered. */
static void *be_served(void *data)
{
	struct raw_stream stream;
	struct raw_reply *reply = malloc(sizeof(*reply));
	struct pursuit_feedback report;
	const int fd = raw_greet(fixture.socket);
	(void)data;
	raw_stream_init(&stream, fd, 1);
	if (!raw_stream_open(&stream, reply))
		atomic_fetch_add(&neighbour.failed, 1);
	while (!atomic_load(&neighbour.stop) && !atomic_load(&neighbour.failed)) {
		raw_fill(&stream);
		raw_publish(&stream);
		atomic_fetch_add(raw_feedback(&stream, &report) ? &neighbour.shown : &neighbour.failed, 1);
	}
	raw_stream_finish(&stream);
	close(fd);
	free(reply);
	return NULL;
}

static void start_neighbour(void)
{
	atomic_store(&neighbour.stop, false);
	CHECK_INT(pthread_create(&neighbour.thread, NULL, be_served, NULL), 0);
}

static void wait_for_reports(unsigned count)
{
	const uint64_t before = atomic_load(&neighbour.shown);
	for (unsigned waited = 0; waited < PATIENCE_MS && atomic_load(&neighbour.shown) < before + count; waited += 5)
		sleep_ms(5);
	CHECK(atomic_load(&neighbour.shown) >= before + count);
	CHECK_INT(atomic_load(&neighbour.failed), 0);
}

static void stop_neighbour(void)
{
	atomic_store(&neighbour.stop, true);
	pthread_join(neighbour.thread, NULL);
}

/* A client in a process of its own; with `traced` it stops itself before its first frame. */
static pid_t fork_client(bool traced)
{
	fflush(stdout);
	const pid_t child = fork();
	if (child != 0)
		return child;
	uint64_t longest = 0;
	if (traced && ptrace(PTRACE_TRACEME, 0, NULL, NULL) < 0)
		_exit(77);
	struct pursuit_stream *stream = game_open(fixture.socket);
	CHECK(stream != NULL);
	if (!play_until_attached(stream, &longest))
		_exit(1);
	if (traced)
		raise(SIGSTOP);
	for (;;) {
		struct pursuit_frame *frame = pursuit_acquire(stream);
		if (frame)
			pursuit_submit(stream, frame);
		if (!traced)
			sleep_ms(5);
	}
}

/* Kills it so many instructions after it was attached. False: no tracing here. */
static bool kill_after(unsigned steps)
{
	int status = 0;
	const pid_t child = fork_client(true);
	waitpid(child, &status, 0);
	if (!WIFSTOPPED(status)) {
		CHECK_INT(status, 77 << 8);
		return false;
	}
	for (unsigned i = 0; i < steps && WIFSTOPPED(status); i++)
		if (ptrace(PTRACE_SINGLESTEP, child, NULL, NULL) < 0 || waitpid(child, &status, 0) < 0)
			break;
	CHECK(WIFSTOPPED(status));
	kill(child, SIGKILL);
	waitpid(child, &status, 0);
	return true;
}

static json_int_t figure(const char *name)
{
	const int fd = raw_greet(fixture.socket);
	const json_int_t value = question_figure(fd, "status", name);
	close(fd);
	return value;
}

/* Only the neighbour's stream is left. */
static void check_streams_gone(void)
{
	json_int_t streams = -1;
	for (unsigned waited = 0; waited < PATIENCE_MS && streams != 1; waited += 10) {
		streams = figure("streams");
		sleep_ms(10);
	}
	CHECK_INT(streams, 1);
}

static void test_clients_killed(void)
{
	uint64_t noise = 88172645463325252u;
	unsigned killed = 0;
	fixture_start(&fixture, NULL);
	start_neighbour();
	wait_for_reports(3);
	const int before = fixture_settled_fds(&fixture);
	for (; killed < kills; killed++) {
		noise ^= noise << 13;
		noise ^= noise >> 7;
		noise ^= noise << 17;
		if (!kill_after((unsigned)(noise % MOST_STEPS)))
			break;
	}
	if (killed < kills)
		printf("       no ptrace here: clients are killed by the clock\n");
	for (unsigned i = killed; i < kills; i++) {
		const pid_t child = fork_client(false);
		sleep_ms(20 + i % 17);
		kill(child, SIGKILL);
		waitpid(child, NULL, 0);
	}
	wait_for_reports(5);
	check_streams_gone();
	CHECK_INT(fixture_settled_fds(&fixture), before);
	printf("       %u clients killed, %u of them after a number of instructions\n", kills, killed);
	stop_neighbour();
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

/* A client that stands still keeps nobody, and goes on when it may. */
static void test_client_stopped(void)
{
	fixture_start(&fixture, NULL);
	start_neighbour();
	wait_for_reports(3);
	const pid_t child = fork_client(false);
	for (unsigned waited = 0; waited < PATIENCE_MS && figure("streams") != 2; waited += 10)
		sleep_ms(10);
	kill(child, SIGSTOP);
	wait_for_reports(60);
	CHECK_INT(figure("streams"), 2);
	const json_int_t received = figure("received_frames");
	kill(child, SIGCONT);
	wait_for_reports(60);
	for (unsigned waited = 0; waited < PATIENCE_MS && figure("received_frames") <= received; waited += 10)
		sleep_ms(10);
	CHECK(figure("received_frames") > received);
	CHECK_INT(figure("streams"), 2);
	kill(child, SIGKILL);
	waitpid(child, NULL, 0);
	check_streams_gone();
	stop_neighbour();
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

int main(int argc, char **argv)
{
	if (argc < 2)
		return 2;
	kills = argc > 2 ? (unsigned)atoi(argv[2]) : kills;
	signal(SIGPIPE, SIG_IGN);
	fixture_init(&fixture, argv[1]);
	RUN(test_daemon_killed);
	RUN(test_clients_killed);
	RUN(test_client_stopped);
	fixture_finish(&fixture);
	return test_result();
}
