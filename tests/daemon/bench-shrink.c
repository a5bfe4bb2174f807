/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What it costs to make a picture smaller: CPU time of one thread, the least of several runs. */
#include <time.h>

#include "daemon/present/shrink.h"
#include "tests/test.h"

#define RUNS 20

static double cpu_ms(void)
{
	struct timespec now;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static void run(const uint32_t size[4])
{
	const size_t from_stride = (size_t)size[0] * 4, to_stride = (size_t)size[2] * 4;
	uint8_t *from = malloc(from_stride * size[1]), *to = malloc(to_stride * size[3]);
	struct shrink *shrink = shrink_create(size[0], size[1], size[2], size[3]);
	double least = HUGE_VAL;
	for (size_t i = 0; i < from_stride * size[1]; i++)
		from[i] = (uint8_t)(i * 2654435761u >> 13);
	for (int i = 0; i < RUNS; i++) {
		const double start = cpu_ms();
		shrink_run(shrink, from, from_stride, to, to_stride);
		least = fmin(least, cpu_ms() - start);
	}
	printf("%4ux%-4u to %4ux%-4u  %6.2f ms\n", size[0], size[1], size[2], size[3], least);
	shrink_destroy(&shrink);
	free(from);
	free(to);
}

int main(void)
{
	static const uint32_t sizes[][4] = {
		{3840, 2160, 1920, 1080}, {2560, 1440, 1920, 1080}, {1920, 1080, 1280, 720}, {1280, 720, 960, 540}};
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
		run(sizes[i]);
	return test_result();
}
