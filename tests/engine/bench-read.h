/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What it is worth that a picture comes back while the next one is drawn. For bench-gpu. */
#ifndef PURSUIT_TESTS_ENGINE_BENCH_READ_H
#define PURSUIT_TESTS_ENGINE_BENCH_READ_H

#include "daemon/engine/engine.h"
#include "tests/engine/picture.h"

struct bench_read {
	struct engine *engine;
	const struct picture *pictures; /* of one size, shown in turn */
	uint32_t picture_count, n;
	uint32_t frames; /* real ones a round */
};

/* Milliseconds by the clock for a real frame, from its planes to all its pictures in memory; the least of the rounds.
 */
struct bench_read_times {
	double waiting; /* each picture is waited for */
	double ahead;   /* the one before the last is */
	bool equal;     /* the pictures are, to the bit */
};

/* Both ways by turns. 0 or a negative errno with a sentence. */
int bench_read(const struct bench_read *bench, struct bench_read_times *times, struct error *error);

#endif
