/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/ratio.h"

#include <math.h>

#define FRACTIONS 5u
/* The two rates slip against each other by a vblank in 33 s at 120 Hz. */
#define SLIP 2.5e-4
/* So much another period is another mode. */
#define OTHER_MODE 0.02
/* What is sure is believed after so many frames in a row, for they share most of what they rest on. */
#define SURE_AFTER 3u
/* A client that ticks may have been held up; one that does not for so many frames does not tick. */
#define IRREGULAR_AFTER 16u
#define LEAST_FRAMES 6u
/* The spread of fewer is itself uncertain. */
#define SURE_FRAMES 16u
/* No line is believed to be straighter. */
#define SPREAD_LEAST_NS 1000.0

/* A straight line through frames' times. */
struct line {
	double slope_ns, doubt_ns; /* a frame */
	double spread_ns;          /* of times about it */
};

void ratio_restart(struct ratio *ratio, uint64_t frame_id, uint64_t time_ns, uint64_t interval_ns)
{
	vblanks_init(&ratio->ticks, UINT64_C(1000000000), interval_ns, time_ns);
	ratio->count = 0;
	ratio->fraction = ratio->found = 1;
	ratio->found_count = 0;
	ratio_add(ratio, frame_id, time_ns);
}

void ratio_add(struct ratio *ratio, uint64_t frame_id, uint64_t time_ns)
{
	vblanks_add(&ratio->ticks, frame_id, time_ns);
	ratio->frames[ratio->count++ % RATIO_HISTORY] = (struct ratio_frame){frame_id, time_ns};
}

/* ---- the client's rate ---- */

/* Least squares through the newest `count` frames. */
static struct line fit(const struct ratio *ratio, uint32_t count)
{
	const struct ratio_frame *newest = &ratio->frames[(ratio->count - 1) % RATIO_HISTORY];
	double x[RATIO_HISTORY], y[RATIO_HISTORY], mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0, rest = 0.0;
	for (uint32_t i = 0; i < count; i++) {
		const struct ratio_frame *frame = &ratio->frames[(ratio->count - 1 - i) % RATIO_HISTORY];
		x[i] = (double)(int64_t)(frame->id - newest->id);
		y[i] = (double)(int64_t)(frame->time_ns - newest->time_ns);
		mean_x += x[i] / count;
		mean_y += y[i] / count;
	}
	for (uint32_t i = 0; i < count; i++) {
		xx += (x[i] - mean_x) * (x[i] - mean_x);
		xy += (x[i] - mean_x) * (y[i] - mean_y);
	}
	struct line line = {.slope_ns = xx > 0.0 ? xy / xx : 0.0};
	for (uint32_t i = 0; i < count; i++) {
		const double off = y[i] - mean_y - line.slope_ns * (x[i] - mean_x);
		rest += off * off / (count - 2.0);
	}
	line.spread_ns = fmax(sqrt(rest), SPREAD_LEAST_NS);
	line.doubt_ns = xx > 0.0 ? (count < SURE_FRAMES ? 6.0 : 3.0) * line.spread_ns / sqrt(xx) : (double)INFINITY;
	return line;
}

/* Through as many of the newest frames as lie on one line, and through all of them where that is the same line. */
static bool find_rate(const struct ratio *ratio, struct line *line)
{
	static const uint32_t counts[] = {8, 12, 16, 24, 32};
	if (ratio->count < LEAST_FRAMES)
		return false;
	*line = fit(ratio, LEAST_FRAMES);
	for (uint32_t i = 0; i < sizeof(counts) / sizeof(counts[0]); i++) {
		const struct line longer = ratio->count < counts[i] ? *line : fit(ratio, counts[i]);
		if (longer.spread_ns > 2.0 * line->spread_ns || ratio->count < counts[i])
			return line->slope_ns > 0.0;
		*line = longer;
	}
	const double period_ns = ratio->ticks.period_ns,
				 doubt_ns = (double)vblanks_get_grid(&ratio->ticks).doubt_ppb * period_ns / 1e9;
	if (doubt_ns < line->doubt_ns && fabs(period_ns - line->slope_ns) <= line->doubt_ns + doubt_ns)
		*line = (struct line){period_ns, doubt_ns, line->spread_ns};
	return line->slope_ns > 0.0;
}

/* ---- the two rates ---- */

enum verdict { NO, UNSURE, YES };

/* Is T = p / q vblanks for a p? */
static enum verdict judge(const struct line *line, const struct grid *display, uint32_t q)
{
	const double vblank_ns = grid_period_ns(display), vblanks = q * line->slope_ns / vblank_ns;
	const double slip = fabs(vblanks - round(vblanks)) / vblanks;
	const double doubt = line->doubt_ns / line->slope_ns + (double)display->doubt_ppb / 1e9;
	if (vblanks <= 0.5 || line->spread_ns >= vblank_ns / (6.0 * q))
		return NO; /* places could not be told apart */
	if (slip <= SLIP && slip + doubt <= 1.5 * SLIP)
		return YES;
	return slip - doubt > SLIP ? NO : UNSURE;
}

/* The fraction that the rates speak for now. While one more is possible that which holds stays. */
static uint32_t find_fraction(const struct ratio *ratio, const struct line *line, const struct grid *display)
{
	bool possible = false;
	for (uint32_t q = 1; q <= FRACTIONS; q++) {
		const enum verdict verdict = judge(line, display, q);
		if (verdict == YES)
			return q;
		possible |= verdict == UNSURE;
	}
	return possible ? ratio->fraction : 0;
}

void ratio_compare(struct ratio *ratio, const struct grid *display)
{
	const double vblank_ns = grid_period_ns(display);
	struct line line;
	if (fabs(vblank_ns - ratio->vblank_ns) > OTHER_MODE * vblank_ns)
		ratio->fraction = ratio->found = 1;
	ratio->vblank_ns = vblank_ns;
	if (!find_rate(ratio, &line))
		return;
	const uint32_t found = find_fraction(ratio, &line, display);
	ratio->found_count = found == ratio->found ? ratio->found_count + 1 : 1;
	ratio->found = found;
	if (ratio->found_count >= (line.spread_ns >= vblank_ns / 6.0 ? IRREGULAR_AFTER : SURE_AFTER))
		ratio->fraction = found;
}
