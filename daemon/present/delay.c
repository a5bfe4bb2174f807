/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/delay.h"

#include <math.h>
#include <stdlib.h>

#define SECOND_NS INT64_C(1000000000)
#define WINDOW_NS (SECOND_NS * 2 / 5)
#define WINDOW_LEAST 5u
#define ALL_NS (SECOND_NS / 5)
/* Until so many frames were shown the display delay is simply where it ought to be. */
#define LEARNING 6u
/* So much another period is another mode. */
#define OTHER_MODE 0.02
/* An age so far from the one before means another time base, not a slower client. */
#define JUMP_NS (SECOND_NS / 4)
/* Parts of a second by which the delay moves in a second. */
#define FAST 0.06
#define SLOW 0.002
#define AT_ONCE_VBLANKS 2.0

static int compare(const void *a, const void *b)
{
	const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
	return (x > y) - (x < y);
}

static const struct delay_sample *newest(const struct delay *delay, uint32_t index)
{
	return &delay->samples[(delay->count - 1 - index) % DELAY_HISTORY];
}

/* How many of the newest samples fill the window. */
static uint32_t window_of(const struct delay *delay)
{
	const uint32_t most = delay->count < DELAY_HISTORY ? delay->count : DELAY_HISTORY;
	uint32_t count = most < WINDOW_LEAST ? most : WINDOW_LEAST;
	while (count < most && newest(delay, 0)->time_ns - newest(delay, count)->time_ns <= (uint64_t)WINDOW_NS)
		count++;
	return count;
}

static uint32_t sort_ages(const struct delay *delay, int64_t sorted[DELAY_HISTORY])
{
	const uint32_t count = window_of(delay);
	for (uint32_t i = 0; i < count; i++)
		sorted[i] = newest(delay, i)->age_ns;
	qsort(sorted, count, sizeof(sorted[0]), compare);
	return count;
}

static int64_t median_ready(const struct delay *delay)
{
	int64_t sorted[DELAY_HISTORY];
	const uint32_t count = window_of(delay);
	for (uint32_t i = 0; i < count; i++)
		sorted[i] = newest(delay, i)->ready_ns;
	qsort(sorted, count, sizeof(sorted[0]), compare);
	return sorted[count / 2];
}

/* Moves towards `target_ns`; `rate` of a second per second. */
static void move(struct delay *delay, int64_t target_ns, double rate, double vblank_ns)
{
	const double off = (double)(target_ns - delay->delay_ns);
	const uint64_t now_ns = newest(delay, 0)->time_ns;
	const int64_t elapsed = now_ns > delay->moved_ns ? (int64_t)(now_ns - delay->moved_ns) : 0;
	const double most = rate * (double)(elapsed < SECOND_NS ? elapsed : SECOND_NS);
	delay->moved_ns = now_ns;
	if (fabs(off) <= most || fabs(off) > AT_ONCE_VBLANKS * vblank_ns)
		delay->delay_ns = target_ns;
	else
		delay->delay_ns += (int64_t)copysign(most, off);
}

/* The middle one of the ages nearest to the delay, which are one place of `fraction` in a vblank; else of all. */
static int64_t nearest_place(const struct delay *delay, const int64_t *sorted, uint32_t count, double width_ns)
{
	uint32_t first = 0, end = count;
	while (first < count && (double)(delay->delay_ns - sorted[first]) >= width_ns / 2.0)
		first++;
	while (end > first && (double)(sorted[end - 1] - delay->delay_ns) >= width_ns / 2.0)
		end--;
	return end > first ? sorted[(first + end) / 2] : sorted[count / 2];
}

/* Did nearly all of the newest frames come half a vblank later, or earlier? */
static bool is_elsewhere(const struct delay *delay, double vblank_ns)
{
	const uint32_t count = window_of(delay);
	uint32_t above = 0, below = 0;
	for (uint32_t i = 0; i < count; i++) {
		const double off = (double)(newest(delay, i)->age_ns - delay->delay_ns);
		above += off > vblank_ns / 2.0;
		below += off < -vblank_ns / 2.0;
		const bool long_enough = newest(delay, 0)->time_ns - newest(delay, i)->time_ns >= (uint64_t)ALL_NS;
		if (long_enough && i + 1 >= WINDOW_LEAST && (above == i + 1 || below == i + 1))
			return true;
	}
	return above * 4 >= count * 3 || below * 4 >= count * 3;
}

/* To one of the places where ages lie. */
static void follow_place(struct delay *delay, uint32_t fraction, double vblank_ns)
{
	int64_t sorted[DELAY_HISTORY];
	const uint32_t count = sort_ages(delay, sorted);
	const int64_t place_ns = nearest_place(delay, sorted, count, vblank_ns / fraction);
	const bool elsewhere = is_elsewhere(delay, vblank_ns);
	const int64_t target_ns = elsewhere || delay->moving ? sorted[count / 2] : place_ns;
	const double off = fabs((double)(target_ns - delay->delay_ns));
	delay->moving = off > vblank_ns / (delay->moving ? 100.0 : 10.0);
	delay->sweeps = false;
	move(delay, target_ns, delay->moving ? FAST : SLOW, vblank_ns);
}

static int64_t middle_of_sweep(const struct delay *delay, double vblank_ns)
{
	return median_ready(delay) + (int64_t)(vblank_ns / 2.0);
}

/* To the middle of the sweep, and no further than that. */
static void follow_sweep(struct delay *delay, double vblank_ns)
{
	const int64_t middle_ns = middle_of_sweep(delay, vblank_ns);
	const double off = fabs((double)(middle_ns - delay->delay_ns));
	delay->moving = off > vblank_ns / (delay->moving || !delay->sweeps ? 32.0 : 4.0);
	delay->sweeps = true;
	move(delay, delay->moving ? middle_ns : delay->delay_ns, FAST, vblank_ns);
}

static void start_where_it_ought_to_be(struct delay *delay, uint32_t fraction, double vblank_ns)
{
	int64_t sorted[DELAY_HISTORY];
	const uint32_t count = sort_ages(delay, sorted);
	delay->delay_ns = fraction > 0 ? sorted[count / 2] : middle_of_sweep(delay, vblank_ns);
	delay->moved_ns = newest(delay, 0)->time_ns;
	delay->sweeps = fraction == 0;
}

void delay_add(struct delay *delay, const struct delay_sample *sample, uint32_t fraction, double vblank_ns)
{
	const bool another_mode = fabs(vblank_ns - delay->vblank_ns) > OTHER_MODE * vblank_ns;
	if (another_mode || (delay->count > 0 && llabs(sample->age_ns - newest(delay, 0)->age_ns) > JUMP_NS))
		delay->count = 0;
	delay->vblank_ns = vblank_ns;
	delay->samples[delay->count++ % DELAY_HISTORY] = *sample;
	if (delay->count <= LEARNING)
		start_where_it_ought_to_be(delay, fraction, vblank_ns);
	else if (fraction > 0)
		follow_place(delay, fraction, vblank_ns);
	else
		follow_sweep(delay, vblank_ns);
}

void delay_undo(struct delay *delay)
{
	if (delay->count > 0)
		delay->count--;
}

int64_t delay_reachable(const struct delay *delay, double vblank_ns)
{
	int64_t sorted[DELAY_HISTORY];
	const uint32_t count = sort_ages(delay, sorted);
	const uint32_t low = count / 10, high = count - 1 - low;
	/* Ages in [least, least + a vblank) were seen, so the least is from (largest - a vblank) to the smallest. */
	const double from = (double)sorted[high] - vblank_ns, to = (double)sorted[low], middle = (from + to) / 2.0;
	const double room = fmax(0.0, (to - from) / 2.0 - vblank_ns / 50.0);
	const double ready = (double)median_ready(delay);
	return (int64_t)fmax(middle - room, fmin(middle + room, ready));
}
