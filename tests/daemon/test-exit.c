/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What stays when the client that is shown has gone: its last picture or black, as on-client-exit says; and that a
 * stream which is opened again is believed nothing about the one before.
 */

#include <jansson.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/daemon/fixture.h"
#include "tests/daemon/question.h"
#include "tests/daemon/raw-client.h"

#define PIXELS ((size_t)RAW_WIDTH * RAW_HEIGHT)

static struct fixture fixture;
static struct raw_reply reply;
static int control;

static void wait_for_rest(void)
{
	question_wait_for_rest(control);
}

static void wait_for_streams(json_int_t most)
{
	for (unsigned waited = 0; waited < PATIENCE_MS && question_figure(control, "status", "streams") > most; waited += 5)
		sleep_ms(5);
	CHECK(question_figure(control, "status", "streams") <= most);
}

/* The mean brightness of the last picture of the video. */
static int last_grey(const char *path)
{
	static uint8_t planes[3 * PIXELS];
	char line[256];
	int grey = -1;
	FILE *file = fopen(path, "r");
	if (!file || !fgets(line, sizeof(line), file))
		return -1;
	while (fgets(line, sizeof(line), file) && fread(planes, sizeof(planes), 1, file) == 1) {
		size_t sum = 0;
		for (size_t i = 0; i < PIXELS; i++)
			sum += planes[i];
		grey = (int)(sum / PIXELS);
	}
	fclose(file);
	return grey;
}

/* A frame that is of this grey all over. */
static struct pursuit_frame_header *fill(struct raw_stream *stream, int grey)
{
	struct pursuit_frame_header *header = raw_fill(stream);
	uint8_t *row = stream->planes + stream->own_slot * RAW_SLOT_BYTES + header->planes[0].offset;
	for (uint32_t y = 0; y < RAW_HEIGHT; y++)
		memset(row + y * header->planes[0].stride, grey, (size_t)RAW_WIDTH * 4);
	return header;
}

/* The stream's picture is of this grey; returns when it was shown. */
static void play(struct raw_stream *stream, int grey)
{
	for (int i = 0; i < 5; i++) {
		struct pursuit_feedback report;
		fill(stream, grey);
		raw_publish(stream);
		CHECK(raw_feedback(stream, &report));
	}
}

static void open_one(struct raw_stream *stream)
{
	const int fd = raw_greet(fixture.socket);
	CHECK(fd >= 0);
	raw_stream_init(stream, fd, 1);
	CHECK(raw_stream_open(stream, &reply));
}

static void close_one(struct raw_stream *stream)
{
	close(stream->socket);
	raw_stream_finish(stream);
}

/* A process that shows this grey and is killed. */
static void show_and_die(int grey)
{
	const json_int_t streams = question_figure(control, "status", "streams");
	const pid_t pid = fork();
	if (pid == 0) {
		struct raw_stream stream;
		open_one(&stream);
		play(&stream, grey);
		raise(SIGKILL);
	}
	int status = 0;
	waitpid(pid, &status, 0);
	CHECK(WIFSIGNALED(status));
	wait_for_streams(streams);
	wait_for_rest();
}

static void start(const char *policy, char *path, size_t size)
{
	char tee[160];
	snprintf(path, size, "%s/shown-%s.y4m", fixture.folder, policy);
	snprintf(tee, sizeof(tee), "--tee=%s", path);
	const char *const arguments[] = {tee, "--on-client-exit", policy, NULL};
	fixture_start(&fixture, arguments);
	control = raw_greet(fixture.socket);
	CHECK(control >= 0);
}

static int stop(const char *path)
{
	close(control);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	const int grey = last_grey(path);
	unlink(path);
	return grey;
}

static void test_keeps(void)
{
	char path[128];
	start("keep", path, sizeof(path));
	show_and_die(150);
	const int grey = stop(path);
	CHECK(grey > 135 && grey < 155);
}

static void test_black(void)
{
	char path[128];
	start("black", path, sizeof(path));
	show_and_die(150);
	const int grey = stop(path);
	CHECK(grey >= 0 && grey <= 16);
}

/* One that only pauses stays; one that closes does not; who was behind it is shown with its next frame. */
static void test_pause_is_no_exit(void)
{
	struct raw_stream stream;
	char path[128];
	start("black", path, sizeof(path));
	open_one(&stream);
	play(&stream, 150);
	wait_for_rest();
	show_and_die(100);
	play(&stream, 200);
	wait_for_rest();
	int grey = stop(path);
	CHECK(grey > 180 && grey < 195);
	close_one(&stream);

	start("black", path, sizeof(path));
	open_one(&stream);
	play(&stream, 150);
	close_one(&stream);
	wait_for_streams(0);
	wait_for_rest();
	grey = stop(path);
	CHECK(grey >= 0 && grey <= 16);
}

/* The choice is taken over while the picture of one that has gone stays. */
static void test_changes(void)
{
	char path[128];
	start("keep", path, sizeof(path));
	show_and_die(150);
	CHECK_INT(raw_control(control, "set on-client-exit=black", -1, &reply), 0);
	wait_for_rest();
	int grey = stop(path);
	CHECK(grey >= 0 && grey <= 60); /* black, and a message about the setting */

	start("black", path, sizeof(path));
	show_and_die(150);
	CHECK_INT(raw_control(control, "set on-client-exit=keep", -1, &reply), 0);
	wait_for_rest();
	grey = stop(path);
	CHECK(grey > 100);
}

/* "Nothing has changed since frame 5" is about frame 5 of this stream, not of the one that had its number before. */
static void test_reopened_stream_is_new(void)
{
	struct pursuit_message_close_stream message = {
		.header = {.type = PURSUIT_MESSAGE_CLOSE_STREAM, .size = sizeof(message), .serial = 9}, .stream_id = 1};
	struct raw_stream stream, again;
	struct pursuit_feedback report;
	char path[128];
	start("keep", path, sizeof(path));
	open_one(&stream);
	play(&stream, 100);
	CHECK_INT(raw_send(stream.socket, &message, sizeof(message), NULL, 0), 0);
	CHECK(raw_receive(stream.socket, &reply));
	CHECK_INT(reply.header.type, PURSUIT_MESSAGE_STREAM_CLOSED);
	raw_stream_init(&again, stream.socket, 1);
	CHECK(raw_stream_open(&again, &reply));
	struct pursuit_frame_header *header = fill(&again, 200);
	header->damage_since = stream.next_id - 1;
	header->frame_id = stream.next_id;
	header->flags |= PURSUIT_FRAME_DAMAGE;
	raw_publish(&again);
	CHECK(raw_feedback(&again, &report));
	wait_for_rest();
	const int grey = stop(path);
	CHECK(grey > 180 && grey < 195);
	raw_stream_finish(&again);
	close_one(&stream);
}

int main(int argc, char **argv)
{
	if (argc < 2)
		return 2;
	fixture_init(&fixture, argv[1]);
	RUN(test_keeps);
	RUN(test_black);
	RUN(test_pause_is_no_exit);
	RUN(test_changes);
	RUN(test_reopened_stream_is_new);
	fixture_finish(&fixture);
	return test_result();
}
