/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The GL context is lost, or the driver has no memory: clients stay, each frame is shown all the same, with the right
 * picture, and GL is used again when it works.
 *
 *   test-gl-loss PURSUITD PRELOAD
 */

#include <fcntl.h>
#include <jansson.h>
#include <signal.h>
#include <unistd.h>

#include "tests/daemon/fixture.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"

#define PIXELS ((size_t)RAW_WIDTH * RAW_HEIGHT)

static struct fixture fixture;
static const char *preload;
static char lose_path[96], memory_path[96], video_path[96];
static struct raw_reply reply;
static int fd;

static bool draws_in(const char *context)
{
	json_t *status = question_ask(fd, "status");
	const bool same = strcmp(json_string_value(json_object_get(status, "context")), context) == 0;
	json_decref(status);
	return same;
}

/* Frames of one grey each, every one of them shown. */
static void play(struct raw_stream *stream, int frames)
{
	for (int i = 0; i < frames; i++) {
		struct pursuit_feedback report;
		raw_fill(stream);
		raw_publish(stream);
		CHECK(raw_feedback(stream, &report));
		CHECK_INT(report.state, PURSUIT_FEEDBACK_SHOWN);
	}
}

static void play_until_in(struct raw_stream *stream, const char *context)
{
	for (int i = 0; i < 60 && !draws_in(context); i++)
		play(stream, 1);
	CHECK(draws_in(context));
}

static void make_file(const char *path)
{
	const int file = open(path, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
	CHECK(file >= 0);
	close(file);
}

/* False: nothing to lose here. */
static bool start(struct raw_stream *stream)
{
	char tee[128];
	snprintf(tee, sizeof(tee), "--tee=%s", video_path);
	const char *const arguments[] = {"--context", "egl", "--method", "pursuit", tee, NULL};
	setenv("LD_PRELOAD", preload, 1);
	fixture_spawn(&fixture, arguments);
	unsetenv("LD_PRELOAD");
	if (!fixture_wait(&fixture)) {
		printf("       no EGL, or no preloading: not tried\n");
		fixture_join(&fixture);
		return false;
	}
	fd = raw_greet(fixture.socket);
	CHECK(fd >= 0);
	raw_stream_init(stream, fd, 1);
	CHECK(raw_stream_open(stream, &reply));
	return true;
}

/* Each picture that was shown is of the grey of one frame, and greys come in the order of frames. */
static void check_video(void)
{
	static uint8_t planes[3 * PIXELS];
	char line[256];
	unsigned pictures = 0, spoilt = 0;
	FILE *file = fopen(video_path, "r");
	CHECK(file && fgets(line, sizeof(line), file));
	for (int before = 0; file && fgets(line, sizeof(line), file) && fread(planes, sizeof(planes), 1, file) == 1;) {
		bool same = planes[0] > 16 && planes[0] + 1 >= before;
		for (size_t i = 0; i < PIXELS; i++)
			same &= planes[i] >= planes[0] - 1 && planes[i] <= planes[0] + 1;
		before = planes[0];
		spoilt += !same;
		pictures++;
	}
	if (file)
		fclose(file);
	unlink(video_path);
	CHECK(pictures > 0);
	CHECK_INT(spoilt, 0);
}

static void stop(struct raw_stream *stream)
{
	CHECK_INT(question_figure(fd, "status", "lost_real_frames"), 0);
	CHECK_INT(question_figure(fd, "status", "refused_frames"), 0);
	raw_stream_finish(stream);
	close(fd);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	check_video();
}

static void test_context_lost(void)
{
	struct raw_stream stream;
	if (!start(&stream))
		return;
	play(&stream, 3);
	CHECK(draws_in("egl-surfaceless"));
	for (int i = 0; i < 3; i++) {
		make_file(lose_path);
		play(&stream, 1); /* GL is asked, and tells, with this frame or before */
		CHECK(access(lose_path, F_OK) != 0);
		CHECK_INT(question_figure(fd, "status", "engine_losses"), i + 1);
		play_until_in(&stream, "egl-surfaceless");
	}
	CHECK(fixture_logged(&fixture, "the engine is lost, to be made anew in 100 ms"));
	CHECK(fixture_logged(&fixture, "to be made anew in 200 ms"));
	CHECK(fixture_logged(&fixture, "the engine is back"));
	stop(&stream);
}

static void test_driver_out_of_memory(void)
{
	struct raw_stream stream;
	if (!start(&stream))
		return;
	make_file(memory_path);
	play(&stream, 4); /* the first needs a texture of its size */
	CHECK(draws_in("cpu"));
	CHECK(fixture_logged(&fixture, "no room for a picture"));
	CHECK(fixture_logged(&fixture, "the engine is lost still"));
	unlink(memory_path);
	play_until_in(&stream, "egl-surfaceless");
	play(&stream, 2);
	stop(&stream);
}

int main(int argc, char **argv)
{
	if (argc < 3)
		return 2;
	preload = argv[2];
	fixture_init(&fixture, argv[1]);
	snprintf(lose_path, sizeof(lose_path), "%s/lose", fixture.folder);
	snprintf(memory_path, sizeof(memory_path), "%s/no-memory", fixture.folder);
	snprintf(video_path, sizeof(video_path), "%s/video.y4m", fixture.folder);
	setenv("PURSUIT_TEST_LOSE", lose_path, 1);
	setenv("PURSUIT_TEST_NO_MEMORY", memory_path, 1);
	RUN(test_context_lost);
	RUN(test_driver_out_of_memory);
	fixture_finish(&fixture);
	return test_result();
}
