/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/interval.h"

#include <math.h>
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
#define FRACTIONS 5u
/* The two rates slip against each other by a vblank in 33 s at 120 Hz. */
#define SLIP 2.5e-4
#define DOUBT_MOST 2e-3
/* So much another period is another mode. */
#define OTHER_MODE 0.02
/* The display's period is learned too, and what is found in so few frames may be its noise. */
#define SURE_AFTER 64u
#define DOUBTFUL_AFTER 16u
/* After so many frames a client that does not tick never will. */
#define IRREGULAR_AFTER 64u

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

static void start_ticks(struct interval *interval, uint64_t frame_id, uint64_t time_ns)
{
	vblanks_init(&interval->ticks, UINT64_C(1000000000), interval->interval_ns, time_ns);
	vblanks_add(&interval->ticks, frame_id, time_ns);
	interval->fraction = 1;
}

static void learn(struct interval *interval, uint64_t interval_ns, uint64_t frame_id, uint64_t time_ns)
{
	if (interval_ns < INTERVAL_MIN_NS || interval_ns > INTERVAL_MAX_NS)
		return;
	const bool first = interval->interval_ns == 0;
	interval->history[interval->count++ % INTERVAL_HISTORY] = interval_ns;
	const bool step = stepped(interval);
	if (step)
		forget(interval, NEWEST_AGREED);
	interval->interval_ns = mean_of(interval, window_of(interval));
	if (first || step)
		start_ticks(interval, frame_id, time_ns);
	else
		vblanks_add(&interval->ticks, frame_id, time_ns);
}

void interval_add(struct interval *interval, uint64_t frame_id, uint64_t time_ns, uint64_t declared_ns)
{
	const uint64_t gap = frame_id - interval->last_id;
	const bool known = interval->last_ns != 0 && time_ns > interval->last_ns;
	const uint64_t passed = known ? time_ns - interval->last_ns : 0;
	interval->last_id = frame_id;
	interval->last_ns = time_ns;
	learn(interval, declared_ns && gap == 1 ? declared_ns : passed, frame_id, time_ns);
}

/* The fraction that the periods speak for now. */
static uint32_t find_fraction(const struct interval *interval, double period_ns)
{
	const struct vblanks *ticks = &interval->ticks;
	if (!vblanks_known(ticks))
		return ticks->stamps > IRREGULAR_AFTER ? 0 : interval->fraction;
	/* The error of a slope that was fitted through so many points (standard deviation, three times). */
	const double n = ticks->memory, doubt = 3.0 * ticks->spread_ns * sqrt(12.0) / (n * sqrt(n)) / ticks->period_ns;
	for (uint32_t q = 1; q <= FRACTIONS; q++) {
		const double vblanks = q * ticks->period_ns / period_ns;
		const double slip = fabs(vblanks - round(vblanks)) / vblanks;
		const bool told_apart = ticks->spread_ns < period_ns / (6.0 * q);
		if (vblanks > 0.5 && told_apart && slip <= SLIP + (interval->fraction == q ? fmin(doubt, DOUBT_MOST) : 0.0))
			return q;
	}
	return 0;
}

void interval_compare(struct interval *interval, double period_ns)
{
	if (interval->interval_ns == 0)
		return;
	if (fabs(period_ns - interval->period_ns) > OTHER_MODE * period_ns)
		interval->fraction = interval->found = 1;
	interval->period_ns = period_ns;
	const uint32_t found = find_fraction(interval, period_ns);
	interval->found_count = found == interval->found ? interval->found_count + 1 : 1;
	interval->found = found;
	if (interval->found_count > (found ? SURE_AFTER : DOUBTFUL_AFTER))
		interval->fraction = found;
}
