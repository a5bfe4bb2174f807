/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include "daemon/record/recorder.h"
#include "tests/record/sample.h"
#include "tests/test.h"

#define FRAMES 100u

static void test_all_frames_in_order(void)
{
	const struct recorder_params params = {.writer = {.path = sample_path("a.pursuit"), .info = "stream=live\n"}};
	struct error error = {""};
	struct recorder *recorder = recorder_create(&params, &error);
	struct recorder_stats stats;
	CHECK(recorder != NULL);
	for (unsigned i = 1; i <= FRAMES; i++) {
		struct sample sample;
		sample_init(&sample, i, 16 + i % 7, 9);
		CHECK(recorder_push(recorder, &sample.frame, i));
		if (i == 50)
			CHECK(recorder_settings(recorder, "method=grid\n", i));
		sample_finish(&sample); /* the copy is what counts from here */
	}
	recorder_stats(recorder, &stats);
	CHECK_INT(stats.frames_dropped, 0);
	CHECK(!stats.failed);
	CHECK_INT(recorder_destroy(&recorder, &stats, &error), 0);
	CHECK(recorder == NULL);
	CHECK_INT(stats.frames_written, FRAMES);
	CHECK_INT(stats.queued_frames, 0);
	CHECK_INT(stats.queued_bytes, 0);
	CHECK_STRING(stats.text, "");
	CHECK_INT(recorder_destroy(&recorder, &stats, &error), 0);

	struct recording_reader *reader =
		recording_reader_create(&(struct recording_reader_params){.path = sample_path("a.pursuit")}, &error);
	CHECK_INT(recording_reader_frame_count(reader), FRAMES);
	CHECK(recording_reader_summary(reader)->closed);
	for (unsigned i = 1; i <= FRAMES; i++) {
		struct frame frame;
		uint64_t time_ns = 0;
		struct sample sample;
		sample_init(&sample, i, 16 + i % 7, 9);
		CHECK_INT(recording_reader_frame(reader, i - 1, 0, &frame, &time_ns, &error), 0);
		CHECK(sample_equal(&frame, &sample.frame));
		CHECK_INT(time_ns, i);
		sample_finish(&sample);
	}
	recording_reader_destroy(&reader);
}

/* Reads a pipe to its end, but only when told to: a disk that hangs. */
struct slow_disk {
	int read_fd;
	pthread_mutex_t hold;
	uint64_t bytes;
};

static void *drain(void *data)
{
	struct slow_disk *disk = data;
	char block[65536];
	pthread_mutex_lock(&disk->hold);
	for (ssize_t got; (got = read(disk->read_fd, block, sizeof(block))) > 0;)
		disk->bytes += (uint64_t)got;
	pthread_mutex_unlock(&disk->hold);
	return NULL;
}

/* A disk that does not take anything: pushes return at once, the queue is bounded, drops are counted. */
static void test_slow_disk_never_blocks(void)
{
	int ends[2];
	struct error error = {""};
	struct recorder_stats stats;
	struct sample sample;
	struct slow_disk disk = {.hold = PTHREAD_MUTEX_INITIALIZER};
	pthread_t thread;
	sample_init(&sample, 1, 200, 200);
	CHECK_INT(pipe2(ends, O_CLOEXEC), 0);
	disk.read_fd = ends[0];
	pthread_mutex_lock(&disk.hold);
	pthread_create(&thread, NULL, drain, &disk);
	const uint64_t bytes = recording_packed_bytes(&sample.frame);
	const struct recorder_params params = {.writer = {.fd = ends[1]}, .queue_bytes = 4 * bytes};
	struct recorder *recorder = recorder_create(&params, &error);
	unsigned taken = 0;
	for (int i = 0; i < 50; i++)
		taken += recorder_push(recorder, &sample.frame, 1);
	recorder_stats(recorder, &stats);
	CHECK(taken >= 4 && taken < 50);
	CHECK_INT(stats.frames_dropped, 50 - taken);
	CHECK(stats.queued_bytes <= 4 * bytes);
	pthread_mutex_unlock(&disk.hold);
	CHECK_INT(recorder_destroy(&recorder, &stats, &error), 0);
	pthread_join(thread, NULL);
	close(ends[0]);
	CHECK_INT(stats.frames_written, taken);
	CHECK_INT(disk.bytes, stats.bytes_written + sizeof(struct pursuit_chunk_header) + 16);
	sample_finish(&sample);
}

static void test_tiny_queue(void)
{
	int ends[2];
	struct error error = {""};
	struct sample sample;
	struct slow_disk disk = {.hold = PTHREAD_MUTEX_INITIALIZER};
	pthread_t thread;
	sample_init(&sample, 1, 200, 200);
	CHECK_INT(pipe2(ends, O_CLOEXEC), 0);
	disk.read_fd = ends[0];
	pthread_mutex_lock(&disk.hold);
	pthread_create(&thread, NULL, drain, &disk);
	/* Smaller than one frame: a frame is still taken when nothing else waits. */
	const struct recorder_params params = {.writer = {.fd = ends[1]}, .queue_bytes = 10};
	struct recorder *recorder = recorder_create(&params, &error);
	CHECK(recorder_push(recorder, &sample.frame, 1));
	CHECK(!recorder_push(recorder, &sample.frame, 1));
	pthread_mutex_unlock(&disk.hold);
	CHECK_INT(recorder_destroy(&recorder, NULL, &error), 0);
	pthread_join(thread, NULL);
	close(ends[0]);
	sample_finish(&sample);
}

/* Bytes of `frames` pictures at this level, 0: as the queue has it, behind a disk that waits until all are pushed. */
static uint64_t bytes_at(int level, unsigned frames, const struct sample *sample)
{
	int ends[2];
	struct error error = {""};
	struct recorder_stats stats;
	struct slow_disk disk = {.hold = PTHREAD_MUTEX_INITIALIZER};
	pthread_t thread;
	CHECK_INT(pipe2(ends, O_CLOEXEC), 0);
	disk.read_fd = ends[0];
	pthread_mutex_lock(&disk.hold);
	pthread_create(&thread, NULL, drain, &disk);
	const uint64_t bytes = recording_packed_bytes(&sample->frame);
	const struct recorder_params params = {.writer = {.fd = ends[1], .level = level}, .queue_bytes = frames * bytes};
	struct recorder *recorder = recorder_create(&params, &error);
	for (unsigned i = 0; i < frames; i++)
		CHECK(recorder_push(recorder, &sample->frame, 1));
	pthread_mutex_unlock(&disk.hold);
	CHECK_INT(recorder_destroy(&recorder, &stats, &error), 0);
	pthread_join(thread, NULL);
	close(ends[0]);
	return disk.bytes;
}

/* The fuller the queue, the less is spent on each frame. */
static void test_level_follows_the_queue(void)
{
	struct sample sample;
	sample_init(&sample, 1, 400, 300);
	const uint64_t most = bytes_at(-20, 16, &sample), middle = bytes_at(-5, 16, &sample),
				   least = bytes_at(1, 16, &sample);
	const uint64_t adapted = bytes_at(0, 16, &sample);
	printf("       at -20 %llu, -5 %llu, 1 %llu, by the queue %llu\n", (unsigned long long)most,
		   (unsigned long long)middle, (unsigned long long)least, (unsigned long long)adapted);
	CHECK(adapted > middle && adapted < most);
	sample_finish(&sample);
}

/* The file size limit stands for a full disk. The thread survives SIGXFSZ though nobody ignores it. */
static void test_disk_fills_up(void)
{
	struct error error = {""};
	struct rlimit before;
	struct recorder_stats stats;
	struct sample sample;
	sample_init(&sample, 1, 64, 64);
	const struct recorder_params params = {.writer = {.path = sample_path("full.pursuit"), .level = 1}};
	CHECK_INT(getrlimit(RLIMIT_FSIZE, &before), 0);
	CHECK_INT(setrlimit(RLIMIT_FSIZE, &(struct rlimit){100000, before.rlim_max}), 0);
	struct recorder *recorder = recorder_create(&params, &error);
	for (;;) {
		recorder_push(recorder, &sample.frame, 1);
		recorder_stats(recorder, &stats);
		if (stats.failed)
			break;
		usleep(500);
	}
	CHECK(strstr(stats.text, "full.pursuit") && strstr(stats.text, "limit"));
	const uint64_t dropped = stats.frames_dropped;
	CHECK(!recorder_push(recorder, &sample.frame, 1));
	recorder_stats(recorder, &stats);
	CHECK(stats.frames_dropped > dropped);
	CHECK_INT(recorder_destroy(&recorder, &stats, &error), -EFBIG);
	CHECK_STRING(error.text, stats.text);
	CHECK_INT(setrlimit(RLIMIT_FSIZE, &before), 0);
	struct recording_reader *reader =
		recording_reader_create(&(struct recording_reader_params){.path = sample_path("full.pursuit")}, &error);
	CHECK(stats.frames_written > 0);
	CHECK_INT(recording_reader_frame_count(reader), stats.frames_written);
	CHECK(!recording_reader_summary(reader)->truncated);
	recording_reader_destroy(&reader);
	sample_finish(&sample);
}

static void test_cannot_create(void)
{
	struct error error = {""};
	const struct recorder_params params = {.writer = {.path = "/no/such/folder/x.pursuit"}};
	CHECK(!recorder_create(&params, &error));
	CHECK(strstr(error.text, "/no/such/folder/x.pursuit") != NULL);
}

/* A file that is open for appending is not meant to be cut; in an empty one nothing is lost. */
static void test_open_for_appending(void)
{
	struct error error = {""};
	const char *path = sample_path("kept.pursuit");
	size_t after = 0;
	sample_write_file(path, path, 16);
	for (off_t offset = 0; offset <= 8; offset += 8) {
		const struct recorder_params params = {.writer = {.fd = open(path, O_WRONLY | O_APPEND | O_CLOEXEC)}};
		CHECK_INT(lseek(params.writer.fd, offset, SEEK_SET), offset);
		CHECK(!recorder_create(&params, &error));
		CHECK(strstr(error.text, "for appending") != NULL);
		free(sample_read_file(path, &after));
		CHECK_INT(after, 16);
	}
	const int fd = open(sample_path("new.pursuit"), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
	const struct recorder_params params = {.writer = {.fd = fd}};
	struct recorder *recorder = recorder_create(&params, &error);
	CHECK(recorder != NULL);
	CHECK_INT(recorder_destroy(&recorder, NULL, &error), 0);
}

int main(void)
{
	RUN(test_all_frames_in_order);
	RUN(test_slow_disk_never_blocks);
	RUN(test_tiny_queue);
	RUN(test_level_follows_the_queue);
	RUN(test_disk_fills_up);
	RUN(test_cannot_create);
	RUN(test_open_for_appending);
	sample_folder_remove();
	return test_result();
}
