/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A histogram of spans in nanoseconds in constant memory, in the manner of
 * HdrHistogram (Tene, hdrhistogram.org): classes that are exact up to 255 ns
 * and 1/128 wide above, out to 1 hour, and the same again below zero, since a
 * flip can come before its target. Count, sum, least and most are exact, and a
 * percentile is right to half a class: 0.4 %.
 *
 * Pure; one thread.
 */
#ifndef PURSUIT_LAB_HISTOGRAM_H
#define PURSUIT_LAB_HISTOGRAM_H

#include <stdint.h>

#define HISTOGRAM_LIMIT_NS INT64_C(3600000000000)
#define HISTOGRAM_HALF 4608u /* classes on each side of zero */

/* Zeroed is empty. */
struct histogram {
	uint32_t positive[HISTOGRAM_HALF], negative[HISTOGRAM_HALF];
	uint64_t count;
	int64_t least, most;
	double sum, square_sum; /* of microseconds, so that hours keep their last digits */
};

/* Spans beyond an hour count as an hour. */
void histogram_add(struct histogram *histogram, int64_t span_ns);
void histogram_merge(struct histogram *histogram, const struct histogram *other);

/* The span that a share (0 to 1) of all lies at or below, within the exact least and most; 0 for none at all. */
double histogram_percentile(const struct histogram *histogram, double share);
double histogram_mean(const struct histogram *histogram);
/* Of the sample; 0 for fewer than two. */
double histogram_deviation(const struct histogram *histogram);

/* How many lie at or above `from_ns` and below `to_ns`, to the nearest class. */
uint64_t histogram_between(const struct histogram *histogram, double from_ns, double to_ns);

#endif
