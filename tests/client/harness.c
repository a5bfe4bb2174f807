/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/client/harness.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

struct harness harness;

bool harness_start(void)
{
	snprintf(harness.folder, sizeof(harness.folder), "/tmp/pursuit-test-XXXXXX");
	if (!mkdtemp(harness.folder)) {
		perror(harness.folder);
		return false;
	}
	snprintf(harness.path, sizeof(harness.path), "%s/socket", harness.folder);
	return true;
}

void harness_finish(void)
{
	unlink(harness.path);
	rmdir(harness.folder);
}

uint64_t now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

void sleep_ms(long ms)
{
	nanosleep(&(struct timespec){.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000}, NULL);
}

static void note_time(uint64_t begin)
{
	uint64_t spent = now() - begin;
	harness.slowest_ns = spent > harness.slowest_ns ? spent : harness.slowest_ns;
}

struct pursuit_frame *timed_acquire(struct pursuit_stream *stream)
{
	uint64_t begin = now();
	struct pursuit_frame *frame = pursuit_acquire(stream);
	note_time(begin);
	return frame;
}

uint64_t timed_submit(struct pursuit_stream *stream, struct pursuit_frame *frame)
{
	uint64_t begin = now();
	uint64_t id = pursuit_submit(stream, frame);
	note_time(begin);
	return id;
}

struct pursuit_stream *open_stream(uint32_t slot_count)
{
	struct pursuit_stream_params params = {
		.width = 64,
		.height = 32,
		.depth_format = PURSUIT_DEPTH_FLOAT32,
		.slot_count = slot_count,
		.socket_path = harness.path,
		.name = "a test",
	};
	uint64_t begin = now();
	struct pursuit_stream *stream = pursuit_open(&params);
	note_time(begin);
	return stream;
}

bool close_stream(struct pursuit_stream **stream)
{
	uint64_t begin = now();
	pursuit_close(stream);
	note_time(begin);
	bool at_once = harness.slowest_ns < AT_ONCE_NS;
	printf("       slowest call: %.1f us\n", (double)harness.slowest_ns * 1e-3);
	harness.slowest_ns = 0;
	return at_once && *stream == NULL;
}

struct pursuit_status status_of(struct pursuit_stream *stream)
{
	struct pursuit_status status;
	pursuit_get_status(stream, &status);
	return status;
}

uint64_t send_frame(struct pursuit_stream *stream, uint8_t value)
{
	struct pursuit_frame *frame = timed_acquire(stream);
	if (!frame) {
		return 0;
	}
	memset(frame->color.data, value, frame->color.stride * frame->color.height);
	memset(frame->depth.data, value, frame->depth.stride * frame->depth.height);
	return timed_submit(stream, frame);
}

bool attach(struct pursuit_stream *stream, struct fake_daemon *daemon)
{
	for (int i = 0; i < 400 && status_of(stream).state != PURSUIT_STATE_ATTACHED; i++) {
		fake_step(daemon);
		pursuit_update(stream);
		sleep_ms(1);
	}
	return status_of(stream).state == PURSUIT_STATE_ATTACHED;
}

int open_files(void)
{
	DIR *directory = opendir("/proc/self/fd");
	int count = 0;

	while (directory && readdir(directory)) {
		count++;
	}
	closedir(directory);
	return count;
}

uint64_t submit_until(struct pursuit_stream *stream, enum pursuit_state state)
{
	uint64_t begin = now();
	while (status_of(stream).state != state && now() - begin < 3000 * MS) {
		send_frame(stream, 1);
		sleep_ms(16);
	}
	return (now() - begin) / MS;
}
