/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/cost.h"

#include <stdlib.h>
#include <string.h>

static int compare(const void *a, const void *b)
{
	const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

void cost_add(struct cost *cost, uint64_t run_ns)
{
	uint64_t sorted[COST_WINDOW];
	cost->runs_ns[cost->count++ % COST_WINDOW] = run_ns;
	const size_t count = cost->count < COST_WINDOW ? (size_t)cost->count : COST_WINDOW;
	memcpy(sorted, cost->runs_ns, count * sizeof(sorted[0]));
	qsort(sorted, count, sizeof(sorted[0]), compare);
	cost->usual_ns = sorted[count / 2];
	/*
	 * A scheduler's whim costs a tenth and half a millisecond more. But where times are all over the place, being
	 * safe would cost more delay than it is worth.
	 */
	const uint64_t safe_ns = sorted[count * 9 / 10] * 11 / 10 + 500000;
	const uint64_t most_ns = cost->usual_ns * 3 / 2 + 1000000;
	cost->safe_ns = safe_ns < most_ns ? safe_ns : most_ns;
}
