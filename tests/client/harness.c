/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/client/harness.h"

#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

struct harness harness;

static void on_continue(int signal)
{
	harness.continued++;
}

bool harness_start(void)
{
	sigaction(SIGCONT, &(struct sigaction){.sa_handler = on_continue, .sa_flags = SA_RESTART}, NULL);
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

/* A call of the shim. */
struct call {
	uint64_t begin_ns;
	long sleeps; /* of this thread, up to then */
	sig_atomic_t continued;
};

static long count_sleeps(void)
{
	struct rusage usage;
	getrusage(RUSAGE_THREAD, &usage);
	return usage.ru_nvcsw;
}

static struct call call_begin(void)
{
	const long sleeps = count_sleeps();
	return (struct call){now(), sleeps, harness.continued};
}

static void call_end(const struct call *call)
{
	uint64_t spent = now() - call->begin_ns;
	const bool slept = count_sleeps() > call->sleeps && harness.continued == call->continued;
	harness.waits += spent >= AT_ONCE_NS && slept;
	harness.slowest_ns = spent > harness.slowest_ns ? spent : harness.slowest_ns;
}

struct pursuit_frame *timed_acquire(struct pursuit_stream *stream)
{
	const struct call call = call_begin();
	struct pursuit_frame *frame = pursuit_acquire(stream);
	call_end(&call);
	return frame;
}

uint64_t timed_submit(struct pursuit_stream *stream, struct pursuit_frame *frame)
{
	const struct call call = call_begin();
	uint64_t id = pursuit_submit(stream, frame);
	call_end(&call);
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
	const struct call call = call_begin();
	struct pursuit_stream *stream = pursuit_open(&params);
	call_end(&call);
	return stream;
}

bool close_stream(struct pursuit_stream **stream)
{
	const struct call call = call_begin();
	pursuit_close(stream);
	call_end(&call);
	const bool at_once = harness.waits == 0;
	printf("       slowest call: %.1f us\n", (double)harness.slowest_ns * 1e-3);
	harness.slowest_ns = 0;
	harness.waits = 0;
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
	const uint64_t end = now() + PATIENCE_NS;
	while (status_of(stream).state != PURSUIT_STATE_ATTACHED && now() < end) {
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

bool submit_until(struct pursuit_stream *stream, enum pursuit_state state)
{
	const uint64_t end = now() + PATIENCE_NS;
	while (status_of(stream).state != state && now() < end) {
		send_frame(stream, 1);
		sleep_ms(16);
	}
	return status_of(stream).state == state;
}
