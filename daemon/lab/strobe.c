/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/strobe.h"

#include <math.h>

#define BUCKET_PERIODS 1.25
/* A pulse so late would lie in another part of the refresh. */
#define LATEST_PERIODS 0.25

static double clamp(double value, double most)
{
	if (!(value > 0.0))
		return 0.0;
	return value < most ? value : most;
}

void strobe_init(struct strobe *strobe, double phase, double duty, double limit, double period_ns)
{
	*strobe = (struct strobe){.period_ns = period_ns};
	strobe_change(strobe, phase, duty, limit);
	strobe->bucket_ns = strobe->limit * period_ns * BUCKET_PERIODS;
}

void strobe_change(struct strobe *strobe, double phase, double duty, double limit)
{
	strobe->phase = clamp(phase, 1.0);
	strobe->limit = clamp(limit, STROBE_MOST);
	strobe->duty = clamp(duty, strobe->limit);
}

uint64_t strobe_due(const struct strobe *strobe, uint64_t flip_ns)
{
	return flip_ns + (uint64_t)llround(strobe->phase * strobe->period_ns);
}

static void fill(struct strobe *strobe, uint64_t now_ns)
{
	const double most = strobe->limit * strobe->period_ns * BUCKET_PERIODS;
	if (strobe->filled_ns != 0 && now_ns > strobe->filled_ns)
		strobe->bucket_ns += strobe->limit * (double)(now_ns - strobe->filled_ns);
	if (strobe->bucket_ns > most)
		strobe->bucket_ns = most;
	strobe->filled_ns = now_ns;
}

uint64_t strobe_begin(struct strobe *strobe, uint64_t due_ns, uint64_t now_ns)
{
	const double width = strobe->duty * strobe->period_ns;
	const bool late = now_ns > due_ns && (double)(now_ns - due_ns) > LATEST_PERIODS * strobe->period_ns;
	fill(strobe, now_ns);
	if (late || strobe->on_ns != 0 || width < 1.0 || strobe->bucket_ns < width) {
		strobe->left_out++;
		return 0;
	}
	strobe->pulses++;
	strobe->on_ns = now_ns;
	return now_ns + (uint64_t)width;
}

void strobe_end(struct strobe *strobe, uint64_t now_ns)
{
	if (strobe->on_ns == 0)
		return;
	const double on = now_ns > strobe->on_ns ? (double)(now_ns - strobe->on_ns) : 0.0;
	fill(strobe, now_ns);
	strobe->bucket_ns -= on;
	strobe->too_long += on > strobe->limit * strobe->period_ns;
	strobe->on_ns = 0;
}
