/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* --tee: a video of what was shown, a frame a vblank, with its times. */

#include <inttypes.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "daemon/record/image.h"
#include "tests/daemon/fixture.h"

#define WIDTH 64u
#define HEIGHT 48u
#define FRAME_BYTES (WIDTH * HEIGHT * 3)
#define LINKS 8000u /* more than there are vblanks in a minute */

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
	for (int i = 0; i < 2400 && shown < frames; i++) {
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

/* Starts with this file, plays so many frames, ends. */
static void play_into(const char *path, uint64_t frames)
{
	char option[192];
	snprintf(option, sizeof(option), "--tee=%s", path);
	const char *const arguments[] = {option, NULL};
	fixture_start(&fixture, arguments);
	play(frames);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
}

/* The last column of the times. */
static void check_numbers(const char *times, uint64_t first, uint64_t count)
{
	char line[256];
	uint64_t number = 0, rows = 0;
	FILE *file = fopen(times, "r");
	CHECK(file && fgets(line, sizeof(line), file));
	for (; file && fgets(line, sizeof(line), file); rows++) {
		CHECK_INT(sscanf(strrchr(line, ','), ",%" SCNu64, &number), 1);
		CHECK_INT(number, first + rows);
	}
	CHECK_INT(rows, count);
	if (file)
		fclose(file);
}

/* Those that are there stay, with their times; numbers go on. */
static void test_images_again(const char *pattern, const char *times, uint64_t before)
{
	char kept[160], path[160];
	struct stat old, now;
	uint64_t images = 0;
	snprintf(path, sizeof(path), "%s/f_00000.png", fixture.folder);
	snprintf(kept, sizeof(kept), "%s.1", times);
	CHECK_INT(stat(path, &old), 0);
	play_into(pattern, 5);
	CHECK(stat(path, &now) == 0 && now.st_ino == old.st_ino && now.st_mtim.tv_nsec == old.st_mtim.tv_nsec);
	do
		snprintf(path, sizeof(path), "%s/f_%05u.png", fixture.folder, (unsigned)(before + images++));
	while (access(path, F_OK) == 0);
	CHECK(--images >= 5);
	check_numbers(times, before, images);
	CHECK_INT(read_times(kept), before);
}

/* An image each, numbered without a gap, as many as there are rows of times. */
static void test_images(void)
{
	char pattern[128], path[160], times[128];
	uint64_t images = 0;
	snprintf(pattern, sizeof(pattern), "%s/f_%%05d.png", fixture.folder);
	snprintf(times, sizeof(times), "%s/times.csv", fixture.folder);
	play_into(pattern, 20);
	for (;; images++) {
		struct image image;
		struct error error;
		snprintf(path, sizeof(path), "%s/f_%05u.png", fixture.folder, (unsigned)images);
		if (access(path, F_OK) != 0)
			break;
		CHECK_INT(image_read(path, IMAGE_BGRA, 0, &image, &error), 0);
		CHECK_INT(image.width, WIDTH);
		CHECK_INT(image.height, HEIGHT);
		CHECK(image.bgra[0] >= 100 && image.bgra[0] < 150 && image.bgra[0] == image.bgra[4 * WIDTH * HEIGHT - 2]);
		image_finish(&image);
	}
	CHECK(images >= 20);
	CHECK_INT(read_times(times), images);
	check_numbers(times, 0, images);
	test_images_again(pattern, times, images);
}

/* After some images: their folder becomes another one, in which each is on a disk that is full. */
static void test_full_images(void)
{
	char pattern[160], path[160], option[192], folder[128], other[128], link[128];
	snprintf(folder, sizeof(folder), "%s/images", fixture.folder);
	snprintf(other, sizeof(other), "%s/full", fixture.folder);
	snprintf(link, sizeof(link), "%s/link", fixture.folder);
	CHECK(mkdir(folder, 0700) == 0 && mkdir(other, 0700) == 0 && symlink("images", link) == 0);
	for (unsigned i = 0; i < LINKS; i++) {
		snprintf(path, sizeof(path), "%s/%u.png", other, i);
		CHECK_INT(symlink("/dev/full", path), 0);
	}
	snprintf(pattern, sizeof(pattern), "%s/%%d.png", link);
	snprintf(option, sizeof(option), "--tee=%s", pattern);
	const char *const arguments[] = {option, NULL};
	fixture_start(&fixture, arguments);
	play(5);
	snprintf(path, sizeof(path), "%s/new", fixture.folder);
	CHECK(symlink("full", path) == 0 && rename(path, link) == 0);
	play(20);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	CHECK(fixture_logged(&fixture, "No space left on device; nothing more is recorded"));
	unsigned there = 0;
	for (unsigned i = 0; i < LINKS; i++) {
		struct stat status;
		snprintf(path, sizeof(path), "%s/%u.png", other, i);
		there += lstat(path, &status) == 0;
	}
	CHECK_INT(there, LINKS - 1); /* half an image is none */
}

/* What is written fails with ENOSPC: said once, frames are shown all the same, and what is not there is counted. */
static void test_disk_full(void)
{
	char path[128];
	snprintf(path, sizeof(path), "%s/full.y4m", fixture.folder);
	CHECK_INT(symlink("/dev/full", path), 0);
	play_into(path, 40);
	CHECK(fixture_logged(&fixture, "No space left on device; nothing more is recorded"));

	test_full_images();
}

/* Or does not end at all: a pipe that nobody reads. */
static void test_disk_that_hangs(void)
{
	char path[128];
	snprintf(path, sizeof(path), "%s/pipe.y4m", fixture.folder);
	CHECK_INT(mkfifo(path, 0600), 0);
	play_into(path, 60);
	CHECK(fixture_logged(&fixture, "pipe.y4m does not keep up, frames are dropped from vblank"));
	CHECK(fixture_logged(&fixture, "pipe.y4m does not take what is written; given up after 0 frames"));
}

static void test_no_such_folder(void)
{
	const char *const arguments[] = {"--tee=/nowhere/shown.y4m", NULL};
	fixture_spawn(&fixture, arguments);
	CHECK_INT(fixture_join(&fixture), 1);
	CHECK(fixture_logged(&fixture, "tee: /nowhere/shown.y4m.csv: No such file or directory"));
	const char *const images[] = {"--tee=/nowhere/%d.png", NULL};
	fixture_spawn(&fixture, images);
	CHECK_INT(fixture_join(&fixture), 1);
	CHECK(fixture_logged(&fixture, "tee: /nowhere/times.csv: No such file or directory"));
}

/* Before anything else is made: a usage error that names option and value. */
static void test_wrong_names(void)
{
	static const char *const wrong[][2] = {
		{"--tee=shown_%x.png", "tee: pattern 'shown_%x.png': must have exactly one %d or %04d"},
		{"--tee=shown_%d_%d.png", "tee: pattern 'shown_%d_%d.png': must have exactly one"},
		{"--tee=shown_%04d.jpg", "tee: pattern 'shown_%04d.jpg': must end in .png"},
		{"--tee=shown_%04d.y4m", "tee: pattern 'shown_%04d.y4m': must end in .png"},
		{"--tee=shown.png", "tee: 'shown.png': must end in .y4m"},
		{"--tee=shown.mp4", "tee: 'shown.mp4': must end in .y4m"},
		{"--tee=y4m", "tee: 'y4m': must end in .y4m"},
	};
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		const char *const arguments[] = {wrong[i][0], NULL};
		fixture_spawn(&fixture, arguments);
		CHECK_INT(fixture_join(&fixture), 2);
		CHECK(fixture_logged(&fixture, wrong[i][1]));
	}
}

int main(int argc, char **argv)
{
	(void)argc;
	fixture_init(&fixture, argv[1]);
	RUN(test_records_what_is_shown);
	RUN(test_images);
	RUN(test_disk_full);
	RUN(test_disk_that_hangs);
	RUN(test_no_such_folder);
	RUN(test_wrong_names);
	fixture_finish(&fixture);
	return test_result();
}
