/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* --tee: a video of what was shown, a frame a vblank, with its times. */

#include <inttypes.h>
#include <signal.h>

#include "client/pursuit.h"
#include "tests/daemon/fixture.h"

#define WIDTH 64u
#define HEIGHT 48u
#define FRAME_BYTES (WIDTH * HEIGHT * 3)

static struct fixture fixture;

static uint64_t count_shown(struct pursuit_stream *stream)
{
	struct pursuit_feedback_report report;
	uint64_t shown = 0;
	while (pursuit_poll_feedback(stream, &report))
		shown += report.shown == PURSUIT_SHOWN;
	return shown;
}

/* A grey that changes with each frame, until so many were shown. */
static void play(uint64_t frames)
{
	const struct pursuit_stream_params params = {.width = WIDTH,
												 .height = HEIGHT,
												 .depth_format = PURSUIT_DEPTH_FLOAT32,
												 .motion_format = PURSUIT_MOTION_FLOAT32,
												 .socket_path = fixture.socket};
	struct pursuit_stream *stream = pursuit_open(&params);
	uint64_t shown = 0;
	for (int i = 0; i < 800 && shown < frames; i++) {
		struct pursuit_frame *frame = pursuit_acquire(stream);
		if (frame) {
			for (uint32_t y = 0; y < HEIGHT; y++)
				memset(frame->color.data + y * frame->color.stride, 100 + i % 50, (size_t)WIDTH * 4);
			pursuit_submit(stream, frame);
		}
		sleep_ms(25);
		shown += count_shown(stream);
	}
	CHECK(shown >= frames);
	pursuit_close(&stream);
}

/* Frames of the video; each is one grey within the range that was played. */
static uint64_t read_video(const char *path)
{
	static uint8_t planes[FRAME_BYTES];
	char line[256] = "";
	uint64_t frames = 0;
	FILE *file = fopen(path, "r");
	CHECK(file != NULL);
	if (!file)
		return 0;
	CHECK(fgets(line, sizeof(line), file) && strncmp(line, "YUV4MPEG2 W64 H48 F120:1 ", 25) == 0);
	while (fgets(line, sizeof(line), file) && strncmp(line, "FRAME", 5) == 0) {
		CHECK_INT(fread(planes, 1, sizeof(planes), file), sizeof(planes));
		CHECK(planes[0] > 95 && planes[0] < 150 && planes[WIDTH * HEIGHT - 1] == planes[0]);
		CHECK_INT(planes[WIDTH * HEIGHT], 128); /* no colour */
		frames++;
	}
	fclose(file);
	return frames;
}

/* Rows of the times; vblanks rise, flips are at their times or later. */
static uint64_t read_times(const char *path)
{
	char line[256] = "";
	uint64_t rows = 0, before = 0;
	FILE *file = fopen(path, "r");
	CHECK(file != NULL);
	if (!file)
		return 0;
	CHECK(fgets(line, sizeof(line), file) && strncmp(line, "vblank,sequence,", 16) == 0);
	while (fgets(line, sizeof(line), file)) {
		uint64_t vblank = 0, sequence = 0, target = 0, flip = 0;
		CHECK_INT(
			sscanf(line, "%" SCNu64 ",%" SCNu64 ",%" SCNu64 ",%" SCNu64 ",timer,", &vblank, &sequence, &target, &flip),
			4);
		CHECK(vblank > before && flip >= target);
		before = vblank;
		rows++;
	}
	fclose(file);
	return rows;
}

static void test_records_what_is_shown(void)
{
	char path[128], times[160], option[160];
	snprintf(path, sizeof(path), "%s/shown.y4m", fixture.folder);
	snprintf(times, sizeof(times), "%s.csv", path);
	snprintf(option, sizeof(option), "--tee=%s", path);
	const char *const arguments[] = {option, NULL};
	fixture_start(&fixture, arguments);
	play(20);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	CHECK(fixture_logged(&fixture, "tee: "));
	const uint64_t frames = read_video(path);
	CHECK(frames >= 20);
	CHECK_INT(read_times(times), frames);
}

static void test_no_such_folder(void)
{
	const char *const arguments[] = {"--tee=/nowhere/shown.y4m", NULL};
	fixture_spawn(&fixture, arguments);
	CHECK_INT(fixture_join(&fixture), 1);
	CHECK(fixture_logged(&fixture, "tee: /nowhere/shown.y4m.csv: No such file or directory"));
}

int main(int argc, char **argv)
{
	(void)argc;
	fixture_init(&fixture, argv[1]);
	RUN(test_records_what_is_shown);
	RUN(test_no_such_folder);
	fixture_finish(&fixture);
	return test_result();
}
