/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/interval.h"

#include <stdlib.h>
#include <string.h>

/* Intervals outside are pauses or nonsense and teach nothing. */
#define INTERVAL_MIN_NS UINT64_C(500000)
#define INTERVAL_MAX_NS UINT64_C(1000000000)
#define WINDOW_NS UINT64_C(500000000)
#define NEWEST 5u
#define NEWEST_AGREED 4u
/* So much another rate is a step and no noise. */
#define STEP_PART 0.2

static int compare(const void *a, const void *b)
{
	const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

/* The newest `count` intervals, sorted. */
static void sort_newest(const struct interval *interval, uint32_t count, uint64_t sorted[INTERVAL_HISTORY])
{
	for (uint32_t i = 0; i < count; i++)
		sorted[i] = interval->history[(interval->count - 1 - i) % INTERVAL_HISTORY];
	qsort(sorted, count, sizeof(sorted[0]), compare);
}

/* How many of the newest intervals fill the window, at least NEWEST if there are. */
static uint32_t window_of(const struct interval *interval)
{
	const uint32_t most = interval->count < INTERVAL_HISTORY ? interval->count : INTERVAL_HISTORY;
	uint64_t sum = 0;
	for (uint32_t i = 0; i < most; i++) {
		sum += interval->history[(interval->count - 1 - i) % INTERVAL_HISTORY];
		if (sum > WINDOW_NS && i + 1 >= NEWEST)
			return i + 1;
	}
	return most;
}

static uint64_t mean_of(const struct interval *interval, uint32_t count)
{
	uint64_t sorted[INTERVAL_HISTORY], sum = 0, within = 0;
	sort_newest(interval, count, sorted);
	const uint64_t median = sorted[count / 2];
	for (uint32_t i = 0; i < count; i++) {
		const bool near = sorted[i] >= median / 2 && sorted[i] <= median + median / 2;
		sum += near ? sorted[i] : 0;
		within += near;
	}
	return sum / within;
}

/* Four of the newest five are longer, or shorter, by more than STEP_PART. */
static bool stepped(const struct interval *interval)
{
	uint64_t sorted[INTERVAL_HISTORY];
	if (interval->count <= NEWEST)
		return false;
	sort_newest(interval, NEWEST, sorted);
	const double known = (double)interval->interval_ns;
	return (double)sorted[NEWEST - NEWEST_AGREED] > known * (1.0 + STEP_PART) ||
		   (double)sorted[NEWEST_AGREED - 1] < known * (1.0 - STEP_PART);
}

/* Keeps only the newest intervals. */
static void forget(struct interval *interval, uint32_t count)
{
	uint64_t kept[INTERVAL_HISTORY];
	for (uint32_t i = 0; i < count; i++)
		kept[i] = interval->history[(interval->count - count + i) % INTERVAL_HISTORY];
	memcpy(interval->history, kept, count * sizeof(kept[0]));
	interval->count = count;
}

static void learn(struct interval *interval, uint64_t interval_ns)
{
	if (interval_ns < INTERVAL_MIN_NS || interval_ns > INTERVAL_MAX_NS)
		return;
	const bool first = interval->interval_ns == 0;
	interval->history[interval->count++ % INTERVAL_HISTORY] = interval_ns;
	interval->stepped = first || stepped(interval);
	if (interval->stepped && !first)
		forget(interval, NEWEST_AGREED);
	interval->interval_ns = mean_of(interval, window_of(interval));
}

void interval_add(struct interval *interval, uint64_t frame_id, uint64_t time_ns, uint64_t declared_ns)
{
	const uint64_t gap = frame_id - interval->last_id;
	const bool known = interval->last_ns != 0 && time_ns > interval->last_ns;
	const uint64_t passed = known ? time_ns - interval->last_ns : 0;
	interval->last_id = frame_id;
	interval->last_ns = time_ns;
	interval->stepped = false;
	learn(interval, declared_ns && gap == 1 ? declared_ns : passed);
}
