/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the engine's benchmarks share: a frame shown whole, timed beside a copy of the same bytes. */
#ifndef PURSUIT_TESTS_ENGINE_BENCH_CLOCK_H
#define PURSUIT_TESTS_ENGINE_BENCH_CLOCK_H

#include "daemon/engine/engine.h"
#include "daemon/frame.h"

#define BENCH_FRAMES 31

struct bench_times {
	double median, least, cpu; /* ms of a real frame with its in-betweens; cpu: of all threads together, least */
	double copy;               /* ms of memcpy of the planes once and of all displayed frames, median, same run */
};

/*
 * Shows `count` frames one after another, BENCH_FRAMES in all after a few unmeasured ones, each as its real frame and
 * n - 1 in-betweens, into four pictures in memory that take turns and keep what they hold, as a presenter's do.
 * `unchanged`: the first of them over and over, by a client that says so. Ends the program if the engine fails.
 */
struct bench_times bench_time(struct engine *engine, const struct frame *frames, uint32_t count, uint32_t n,
							  bool unchanged);

/* "auto", "surfaceless", "osmesa", "cpu", ..., with "all-" before it one that leaves nothing out; an engine of that
 * kind, or the end of the program. */
struct engine *bench_engine(const char *context, const char *method);

/* Memory of the process, MB: the most so far. */
double bench_most_memory(void);

#endif
