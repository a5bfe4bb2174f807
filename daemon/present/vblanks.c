/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/vblanks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PERIOD_MIN_NS 500000.0
#define PERIOD_MAX_NS 2e9
#define MEMORY_MOST 256u
/* What the wished period, or one taken from a few intervals, is worth in stamps. */
#define MEMORY_FIRST 6u
/* Enough for a period that is measured. */
#define MEMORY_KNOWN 32u
#define STRAYS_MOST 8u
#define PAUSE_VBLANKS 64.0
/* A stamp belongs to the vblank that it precedes by at most so much of a period. */
#define EARLY 0.25
/* Stamps are whole ns, and no line is straighter than that. */
#define SPREAD_LEAST_NS 200.0

/* ---- the line ---- */

static double limit(double value, double least, double most)
{
	return value < least ? least : value > most ? most : value;
}

/* Moves the line's base to a later vblank and by an offset, without losing parts of a ns. */
static void move_base(struct vblanks *v, uint64_t vblanks, double offset_ns)
{
	const double way = v->rest_ns + (double)vblanks * v->period_ns + offset_ns;
	const double whole = floor(way);
	v->number += vblanks;
	v->base_ns = whole >= 0.0                    ? v->base_ns + (uint64_t)whole
				 : v->base_ns > (uint64_t)-whole ? v->base_ns - (uint64_t)-whole
												 : 0;
	v->rest_ns = way - whole;
}

static double distance(const struct vblanks *v, uint64_t time_ns)
{
	return (double)(int64_t)(time_ns - v->base_ns) - v->rest_ns;
}

/* Begins a line at this stamp. spread_ns: as far from it as stamps are thought to lie. */
static void restart(struct vblanks *v, uint64_t time_ns, double period_ns, double spread_ns)
{
	v->base_ns = time_ns;
	v->rest_ns = 0.0;
	v->period_ns = limit(period_ns, PERIOD_MIN_NS, PERIOD_MAX_NS);
	v->spread_ns = fmin(spread_ns, v->period_ns / 16.0);
	v->bias_ns = 0.0;
	v->memory = MEMORY_FIRST;
	v->strays = 0;
	v->interval_count = 0;
}

void vblanks_init(struct vblanks *v, uint64_t numerator, uint64_t denominator, uint64_t now_ns)
{
	memset(v, 0, sizeof(*v));
	v->wished = (struct grid){.numerator = numerator, .denominator = denominator, .epoch_ns = now_ns};
	if (numerator == 0 || denominator == 0) {
		v->wished.numerator = 120;
		v->wished.denominator = 1;
	}
	restart(v, now_ns, grid_period_ns(&v->wished), INFINITY);
}

/* The stamp's distance from the line moves the line, unless it is a stray. */
static void fit(struct vblanks *v, uint64_t vblanks, uint64_t time_ns)
{
	const double period = v->period_ns;
	move_base(v, vblanks, 0.0);
	const double off = distance(v, time_ns);
	const double spread = fmax(v->spread_ns, SPREAD_LEAST_NS);
	if (fabs(off) > limit(6.0 * spread, 0.01 * period, 0.35 * period)) {
		v->strays++;
		v->outliers++;
		v->spread_ns += (fmin(fabs(off), 0.35 * period) - v->spread_ns) / 64.0;
		return;
	}
	v->strays = 0;
	v->memory += v->memory < MEMORY_MOST;
	const double n = v->memory, settled = v->memory > MEMORY_KNOWN ? limit(off, -3.0 * spread, 3.0 * spread) : off;
	v->period_ns = limit(period + 6.0 / (n * (n + 1.0)) * settled / (double)vblanks, PERIOD_MIN_NS, PERIOD_MAX_NS);
	move_base(v, 0, 2.0 * (2.0 * n - 1.0) / (n * (n + 1.0)) * settled);
	/* A mean of those since the beginning, which what was thought then weighs in for two. */
	v->spread_ns += (fabs(off) - v->spread_ns) / limit(n - MEMORY_FIRST + 2.0, 3.0, 64.0);
	v->bias_ns += (off - v->bias_ns) / 24.0;
	if (v->memory > MEMORY_KNOWN && fabs(v->bias_ns) > 0.75 * spread) { /* it bends: forget what was */
		v->memory = MEMORY_KNOWN / 2;
		v->bias_ns = 0.0;
	}
}

/* ---- steps of the period ---- */

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Sorts the newest intervals; false if there are not so many. */
static bool newest_intervals(const struct vblanks *v, uint32_t count, double *sorted)
{
	if (v->interval_count < count)
		return false;
	for (uint32_t i = 0; i < count; i++)
		sorted[i] = v->intervals[(v->interval_count - 1 - i) % VBLANKS_INTERVALS];
	qsort(sorted, count, sizeof(sorted[0]), compare);
	return true;
}

/*
 * The period that the newest stamps speak for, 0: the one that is known. counted: a multiple is no missed stamps.
 * spread_ns: how far intervals of it lie from each other.
 */
static double find_step(const struct vblanks *v, bool counted, double *spread_ns)
{
	double sorted[VBLANKS_INTERVALS];
	*spread_ns = INFINITY;
	if (newest_intervals(v, VBLANKS_INTERVALS, sorted) && sorted[0] > 1.5 * v->period_ns)
		return sorted[VBLANKS_INTERVALS / 2];
	if (!newest_intervals(v, STRAYS_MOST, sorted))
		return 0.0;
	const double median = (sorted[STRAYS_MOST / 2 - 1] + sorted[STRAYS_MOST / 2]) / 2.0;
	const double ratio = median / v->period_ns;
	const bool multiple = !counted && ratio > 1.5 && fabs(ratio - round(ratio)) < 0.05;
	/* Six of eight intervals lie within so much; their median is surer by far. */
	*spread_ns = sorted[STRAYS_MOST - 2] - sorted[1];
	const double doubt = *spread_ns / v->period_ns;
	if (ratio < 0.85 || (fabs(ratio - 1.0) > 0.01 + 1.5 * doubt && !multiple))
		return median;
	if (v->strays < STRAYS_MOST)
		return 0.0;
	/* The same period with another phase, or without a sequence a few that were missed. */
	return fabs(ratio - 1.0) < 0.005 || (ratio > 1.5 && !counted) ? v->period_ns : median;
}

static void learn_interval(struct vblanks *v, double interval_ns, bool counted, uint64_t time_ns)
{
	if (interval_ns < PERIOD_MIN_NS / 2.0 || interval_ns > PERIOD_MAX_NS)
		return;
	v->intervals[v->interval_count++ % VBLANKS_INTERVALS] = interval_ns;
	double spread_ns;
	const double step_ns = find_step(v, counted, &spread_ns);
	if (step_ns == 0.0)
		return;
	v->steps++;
	restart(v, time_ns, step_ns, spread_ns);
}

/* ---- stamps ---- */

/* By how much the display's own count rose, 0: unknown or not to be believed. */
static uint64_t count_rise(const struct vblanks *v, uint64_t sequence, double passed)
{
	if (sequence == 0 || v->last_sequence == 0)
		return 0;
	uint64_t rise = sequence - v->last_sequence;
	if (sequence < v->last_sequence && v->last_sequence <= UINT32_MAX)
		rise = (uint32_t)rise;
	return rise > 0 && fabs(passed - (double)rise) <= 4.0 + (double)rise / 4.0 ? rise : 0;
}

static uint64_t first_stamp(struct vblanks *v, uint64_t sequence, uint64_t time_ns)
{
	const uint64_t early = (uint64_t)(v->period_ns * (1.0 - EARLY));
	v->number = grid_at_or_after(&v->wished, time_ns > early ? time_ns - early : 0);
	restart(v, time_ns, v->period_ns, INFINITY);
	v->started = true;
	v->last_ns = time_ns;
	v->last_sequence = sequence;
	return v->number;
}

/* A clock does not go back; but where one stamp was nonsense, those after it are not. */
static uint64_t backwards(struct vblanks *v, uint64_t sequence, uint64_t time_ns)
{
	v->outliers++;
	if (++v->backwards < STRAYS_MOST)
		return v->number;
	v->backwards = 0;
	v->steps++;
	v->number++;
	restart(v, time_ns, v->period_ns, INFINITY);
	v->last_ns = time_ns;
	v->last_sequence = sequence;
	return v->number;
}

uint64_t vblanks_add(struct vblanks *v, uint64_t sequence, uint64_t time_ns)
{
	v->stamps++;
	if (!v->started)
		return first_stamp(v, sequence, time_ns);
	if (time_ns <= v->last_ns)
		return backwards(v, sequence, time_ns);
	const double passed = distance(v, time_ns) / v->period_ns;
	const uint64_t rise = count_rise(v, sequence, passed);
	const uint64_t vblanks = rise ? rise : passed + EARLY > 0.0 ? (uint64_t)(passed + EARLY) : 0;
	const double interval_ns = (double)(time_ns - v->last_ns) / (rise ? (double)rise : 1.0);

	v->backwards = 0;
	v->last_ns = time_ns;
	v->last_sequence = sequence;
	v->missed += vblanks > 1 ? vblanks - 1 : 0;
	if (passed > PAUSE_VBLANKS) {
		v->number += vblanks;
		restart(v, time_ns, v->period_ns, INFINITY);
		v->memory = MEMORY_KNOWN;
		return v->number;
	}
	if (vblanks > 0)
		fit(v, vblanks, time_ns);
	else
		v->outliers++;
	learn_interval(v, interval_ns, rise != 0, time_ns);
	return v->number;
}

/* Three standard deviations of a slope through so many points, of which 1.25 mean distances are one. */
static uint64_t doubt_ppb(const struct vblanks *v)
{
	const double n = v->memory, spread = 1.25 * fmax(v->spread_ns, SPREAD_LEAST_NS);
	return (uint64_t)limit(3e9 * spread * sqrt(12.0) / (n * sqrt(n)) / v->period_ns, 1.0, 1e9);
}

struct grid vblanks_get_grid(const struct vblanks *v)
{
	if (!v->started)
		return v->wished;
	return (struct grid){.numerator = UINT64_C(1000000000000000),
						 .denominator = (uint64_t)(v->period_ns * 1e6 + 0.5),
						 .epoch_ns = v->base_ns,
						 .epoch_vblank = v->number,
						 .doubt_ppb = doubt_ppb(v)};
}

bool vblanks_known(const struct vblanks *v)
{
	return v->memory >= MEMORY_KNOWN;
}
