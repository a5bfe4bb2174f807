/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* How fast frames go into a recording and come back, per zstd level, and what a push costs the pushing thread. */

#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "daemon/record/recorder.h"
#include "tests/record/sample.h"

#define FRAMES 10
#define PUSHES 90

static double clock_ms(clockid_t clock)
{
	struct timespec t;
	clock_gettime(clock, &t);
	return (double)t.tv_sec * 1e3 + (double)t.tv_nsec / 1e6;
}

static double now_ms(void)
{
	return clock_ms(CLOCK_MONOTONIC);
}

static double picture_value(uint32_t x, uint32_t y, uint32_t c)
{
	const uint32_t noise = (x * 73856093u ^ y * 19349663u ^ c) * 2654435761u;
	return 100.0 + 60.0 * ((x / 40 + y / 30) % 2) + x / 64.0 + (double)(noise >> 29);
}

/* A picture with edges, gradients and grain; depth and motion that vary smoothly. */
static void paint(struct sample *sample)
{
	for (uint32_t i = 0; i < 3; i++) {
		const struct pursuit_plane *p = &sample->frame.header.planes[i];
		for (uint32_t y = 0; y < p->height; y++)
			for (uint32_t x = 0; x < p->width; x++) {
				uint8_t *at = sample->memory + p->offset + y * p->stride + 4 * (size_t)x;
				if (i == 0)
					for (uint32_t c = 0; c < 4; c++)
						at[c] = (uint8_t)picture_value(x, y, c);
				else if (i == 1)
					*(float *)(void *)at = 1.0f / (1.0f + (float)y * 0.01f + (float)x * 1e-4f);
				else
					*(uint32_t *)(void *)at = 0x3c003c00u + (x >> 4) + (y >> 3);
			}
	}
}

static void bench_level(const struct sample *sample, int level)
{
	struct error error;
	const struct recording_writer_params params = {.path = sample_path("bench.pursuit"), .level = level};
	struct recording_writer *writer = recording_writer_create(&params, &error);
	struct frame frame;
	uint64_t bytes, frames;
	const double start = now_ms();
	for (int i = 0; i < FRAMES; i++)
		recording_writer_frame(writer, &sample->frame, 1, &error);
	const double written = now_ms();
	recording_writer_counts(writer, &bytes, &frames);
	recording_writer_close(&writer, &error);
	const double raw = (double)recording_packed_bytes(&sample->frame) * FRAMES;
	const double synced = now_ms();
	struct recording_reader *reader =
		recording_reader_create(&(struct recording_reader_params){.path = params.path}, &error);
	for (uint64_t i = 0; i < FRAMES; i++)
		recording_reader_frame(reader, i, 0, &frame, NULL, &error);
	const double read = now_ms();
	recording_reader_destroy(&reader);
	printf("recording level %d: write %.0f MB/s, read %.0f MB/s, ratio %.2f, %.1f ms a frame\n", level,
		   raw / 1e3 / (written - start), raw / 1e3 / (read - synced), raw / (double)bytes, (written - start) / FRAMES);
}

static void bench_push(const struct sample *sample)
{
	struct error error;
	struct recorder_stats stats;
	const struct recorder_params params = {.writer = {.path = sample_path("push.pursuit")}};
	struct recorder *recorder = recorder_create(&params, &error);
	double worst = 0, sum = 0;
	const double cpu = clock_ms(CLOCK_THREAD_CPUTIME_ID);
	for (int i = 0; i < PUSHES; i++) {
		const double start = now_ms();
		recorder_push(recorder, &sample->frame, 1);
		const double took = now_ms() - start;
		worst = took > worst ? took : worst;
		sum += took;
		usleep(33000);
	}
	recorder_destroy(&recorder, &stats, &error);
	printf("recorder %d pushes at 30 Hz: mean %.2f ms (%.2f of CPU), worst %.2f ms, %llu dropped, %llu written\n",
		   PUSHES, sum / PUSHES, (clock_ms(CLOCK_THREAD_CPUTIME_ID) - cpu) / PUSHES, worst,
		   (unsigned long long)stats.frames_dropped, (unsigned long long)stats.frames_written);
}

int main(void)
{
	static const uint32_t sizes[][2] = {{640, 360}, {1920, 1080}};
	static const int levels[] = {-20, -5, 1, 3};
	for (int s = 0; s < 2; s++) {
		struct sample sample;
		sample_init(&sample, 1, sizes[s][0], sizes[s][1]);
		sample.frame.header.plane_count = 3;
		paint(&sample);
		printf("%ux%u, %.1f MB a frame\n", sizes[s][0], sizes[s][1],
			   (double)recording_packed_bytes(&sample.frame) / 1e6);
		for (size_t i = 0; i < sizeof(levels) / sizeof(levels[0]); i++)
			bench_level(&sample, levels[i]);
		bench_push(&sample);
		sample_finish(&sample);
	}
	sample_folder_remove();
	return 0;
}
