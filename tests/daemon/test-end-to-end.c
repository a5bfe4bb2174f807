/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A game that links libpursuit: frames arrive, are shown, feedback adds up; both sides may die. */

#include <pthread.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "tests/daemon/fixture.h"

#define WIDTH 96
#define HEIGHT 64
#define FPS 40

static struct fixture fixture;
static int idle_fds; /* of the daemon without clients */

struct counts {
	uint64_t shown, replaced, refused, in_betweens, vblanks, late, hinted;
	uint64_t last_id;
};

static void draw(struct pursuit_frame *frame, uint64_t index)
{
	for (uint32_t y = 0; y < HEIGHT; y++) {
		uint8_t *color = frame->color.data + y * frame->color.stride;
		float *depth = (float *)(void *)(frame->depth.data + y * frame->depth.stride);
		float *motion = (float *)(void *)(frame->motion.data + y * frame->motion.stride);
		for (uint32_t x = 0; x < WIDTH; x++) {
			memset(color + 4 * x, (int)((x + 3 * index) * 8 & 0xff), 4);
			depth[x] = y < HEIGHT / 2 ? 0.3f : 0.6f;
			motion[2 * x] = y < HEIGHT / 2 ? -3.0f : 0.0f;
			motion[2 * x + 1] = 0.0f;
		}
	}
}

static struct pursuit_stream *open_stream(void)
{
	const struct pursuit_stream_params params = {.width = WIDTH,
												 .height = HEIGHT,
												 .depth_format = PURSUIT_DEPTH_FLOAT32,
												 .motion_format = PURSUIT_MOTION_FLOAT32,
												 .socket_path = fixture.socket,
												 .name = "test game"};
	return pursuit_open(&params);
}

static void poll_feedback(struct pursuit_stream *stream, struct counts *counts)
{
	struct pursuit_feedback_report report;
	while (pursuit_poll_feedback(stream, &report)) {
		counts->shown += report.shown == PURSUIT_SHOWN;
		counts->replaced += report.shown == PURSUIT_REPLACED;
		counts->refused += report.shown == PURSUIT_REFUSED;
		counts->in_betweens += report.in_betweens;
		counts->vblanks += report.vblanks;
		counts->late += report.late_in_betweens;
		counts->hinted += report.next_submit_ns > report.submit_ns;
		CHECK(report.frame_id > counts->last_id);
		counts->last_id = report.frame_id;
		if (report.shown == PURSUIT_SHOWN)
			CHECK(report.submit_ns <= report.ready_ns && report.ready_ns <= report.flip_ns);
	}
}

/* Plays so many frames at 40 a second. */
static void play(struct pursuit_stream *stream, int frames, struct counts *counts)
{
	static uint64_t index;
	const uint64_t start = now_ns();
	for (int i = 0; i < frames; i++, index++) {
		struct pursuit_frame *frame = pursuit_acquire(stream);
		CHECK(frame != NULL);
		if (frame) {
			draw(frame, index);
			CHECK(pursuit_submit(stream, frame) > 0);
		}
		poll_feedback(stream, counts);
		const uint64_t next = start + (uint64_t)(i + 1) * 1000000000u / FPS, now = now_ns();
		if (now < next)
			sleep_ms((unsigned)((next - now) / 1000000));
	}
}

/* Plays until the stream is attached and a frame was shown; false after 60 s. */
static bool play_until_shown(struct pursuit_stream *stream, struct counts *counts)
{
	const uint64_t before = counts->shown;
	for (int i = 0; i < 60 * FPS && counts->shown == before; i++)
		play(stream, 1, counts);
	return counts->shown > before;
}

/* A pause closes the last report. */
static void wait_for_reports(struct pursuit_stream *stream, struct counts *counts)
{
	struct pursuit_status status;
	pursuit_get_status(stream, &status);
	for (unsigned waited = 0; waited < PATIENCE_MS; waited += 10) {
		poll_feedback(stream, counts);
		if (counts->shown + counts->replaced + status.replaced >= status.published)
			break;
		sleep_ms(10);
	}
}

static void test_two_seconds(void)
{
	struct counts counts = {0};
	struct pursuit_status status;
	struct pursuit_stream *stream = open_stream();
	CHECK(play_until_shown(stream, &counts));
	play(stream, 2 * FPS, &counts);
	for (int i = 0; i < 60 * FPS && (counts.shown <= FPS / 2 || counts.in_betweens == 0); i++)
		play(stream, 1, &counts);
	wait_for_reports(stream, &counts);
	pursuit_get_status(stream, &status);
	CHECK_INT(status.state, PURSUIT_STATE_ATTACHED);
	CHECK_NEAR(status.refresh_hz, 120, 0.01);
	/* What was published was replaced in the slot, or reported. */
	CHECK_INT(counts.shown + counts.replaced + status.replaced, status.published);
	CHECK_INT(counts.refused, 0);
	CHECK(counts.shown > FPS / 2);
	CHECK(counts.in_betweens > 0);
	CHECK(counts.hinted > 0);
	CHECK(counts.vblanks >= counts.shown + counts.in_betweens + counts.late);
	pursuit_close(&stream);
}

/* A game that begins each frame when the daemon says; it is told so, and nothing waits longer than it may. */
static void test_waiting_for_the_next_frame(void)
{
	struct counts counts = {0};
	struct pursuit_stream *stream = open_stream();
	int told = 0;
	CHECK(play_until_shown(stream, &counts));
	play(stream, 5, &counts);
	for (int i = 0; i < 3 * FPS || (i < 60 * FPS && (told <= FPS / 2 || counts.shown <= FPS / 4)); i++) {
		struct pursuit_frame *frame = pursuit_acquire(stream);
		if (frame) {
			draw(frame, (uint64_t)i);
			pursuit_submit(stream, frame);
		}
		poll_feedback(stream, &counts);
		sleep_ms(5);
		told += pursuit_wait_next(stream, 100000000);
	}
	CHECK(told > FPS / 2);
	CHECK(counts.shown > FPS / 4);
	pursuit_close(&stream);
}

/* The daemon has more descriptors than without clients. */
static bool wait_for_a_stream(void)
{
	for (unsigned waited = 0; waited < PATIENCE_MS && fixture_count_fds(&fixture) < idle_fds + 3; waited += 10)
		sleep_ms(10);
	return fixture_count_fds(&fixture) >= idle_fds + 3;
}

static void test_client_is_killed(void)
{
	struct counts counts = {0};
	const pid_t child = fork();
	if (child == 0) {
		struct pursuit_stream *stream = open_stream();
		play(stream, 100 * FPS, &counts);
		_exit(0);
	}
	CHECK(wait_for_a_stream());
	sleep_ms(200);
	kill(child, SIGKILL);
	waitpid(child, NULL, 0);
	CHECK(fixture_fds_become(&fixture, idle_fds));
	struct pursuit_stream *stream = open_stream();
	CHECK(play_until_shown(stream, &counts));
	pursuit_close(&stream);
}

static void test_daemon_restarts(void)
{
	static const int signals[] = {SIGTERM, SIGKILL};
	static const char *const arguments[] = {"--method", "grid", NULL};
	struct counts counts = {0};
	struct pursuit_status status;
	struct pursuit_stream *stream = open_stream();
	CHECK(play_until_shown(stream, &counts));
	for (size_t i = 0; i < 2; i++) {
		fixture_stop(&fixture, signals[i]);
		play(stream, 10, &counts);
		fixture_start(&fixture, arguments);
		CHECK(play_until_shown(stream, &counts));
		pursuit_get_status(stream, &status);
		CHECK_INT(status.state, PURSUIT_STATE_ATTACHED);
		CHECK_INT(status.attaches, i + 2);
	}
	pursuit_close(&stream);
}

/* The newest stream is shown, the older one's frames are answered; then it has the output again. */
static void test_two_streams(void)
{
	struct counts first = {0}, second = {0};
	struct pursuit_stream *a = open_stream(), *b;
	CHECK(play_until_shown(a, &first));
	b = open_stream();
	CHECK(play_until_shown(b, &second));
	first = (struct counts){.last_id = first.last_id};
	for (int i = 0; i < 60 * FPS && (first.replaced < 5 || second.shown < 5); i++) {
		play(a, 1, &first);
		play(b, 1, &second);
	}
	CHECK(first.replaced >= 5);
	CHECK(second.shown >= 5);
	pursuit_close(&b);
	CHECK(play_until_shown(a, &first));
	pursuit_close(&a);
}

int main(int argc, char **argv)
{
	static const char *const arguments[] = {"--method", "grid", NULL};
	if (argc < 2)
		return 2;
	signal(SIGPIPE, SIG_IGN);
	fixture_init(&fixture, argv[1]);
	fixture_start(&fixture, arguments);
	idle_fds = fixture_settled_fds(&fixture);
	RUN(test_two_seconds);
	RUN(test_waiting_for_the_next_frame);
	RUN(test_client_is_killed);
	RUN(test_two_streams);
	RUN(test_daemon_restarts);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	fixture_finish(&fixture);
	return test_result();
}
