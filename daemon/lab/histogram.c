/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/histogram.h"

#include <math.h>

/* Each doubling has 2^7 classes; the first 2^8 are 1 ns wide. */
#define BITS 7u

static uint32_t class_of(uint64_t span)
{
	const uint32_t top = 63u - (uint32_t)__builtin_clzll(span | 1);
	const uint32_t shift = top > BITS ? top - BITS : 0;
	return (shift << BITS) + (uint32_t)(span >> shift);
}

static double class_start(uint32_t index)
{
	const uint32_t shift = index >> (BITS + 1) ? (index >> BITS) - 1 : 0;
	return ldexp((double)(index - (shift << BITS)), (int)shift);
}

/* Whole numbers: the middle of the class 5..5 is 5. */
static double class_middle(uint32_t index)
{
	return (class_start(index) + class_start(index + 1) - 1.0) / 2.0;
}

void histogram_add(struct histogram *histogram, int64_t span_ns)
{
	if (span_ns > HISTOGRAM_LIMIT_NS)
		span_ns = HISTOGRAM_LIMIT_NS;
	if (span_ns < -HISTOGRAM_LIMIT_NS)
		span_ns = -HISTOGRAM_LIMIT_NS;
	if (span_ns < 0)
		histogram->negative[class_of((uint64_t)-span_ns)]++;
	else
		histogram->positive[class_of((uint64_t)span_ns)]++;
	if (histogram->count == 0 || span_ns < histogram->least)
		histogram->least = span_ns;
	if (histogram->count == 0 || span_ns > histogram->most)
		histogram->most = span_ns;
	const double us = (double)span_ns / 1e3;
	histogram->count++;
	histogram->sum += us;
	histogram->square_sum += us * us;
}

void histogram_merge(struct histogram *histogram, const struct histogram *other)
{
	if (other->count == 0)
		return;
	for (uint32_t i = 0; i < HISTOGRAM_HALF; i++) {
		histogram->positive[i] += other->positive[i];
		histogram->negative[i] += other->negative[i];
	}
	if (histogram->count == 0 || other->least < histogram->least)
		histogram->least = other->least;
	if (histogram->count == 0 || other->most > histogram->most)
		histogram->most = other->most;
	histogram->count += other->count;
	histogram->sum += other->sum;
	histogram->square_sum += other->square_sum;
}

static double within(const struct histogram *histogram, double value)
{
	if (value < (double)histogram->least)
		return (double)histogram->least;
	return value > (double)histogram->most ? (double)histogram->most : value;
}

double histogram_percentile(const struct histogram *histogram, double share)
{
	const double wanted = share * (double)histogram->count;
	uint64_t seen = 0;
	if (histogram->count == 0)
		return 0.0;
	if (wanted >= (double)histogram->count)
		return (double)histogram->most;
	for (uint32_t i = HISTOGRAM_HALF; i-- > 0;) {
		seen += histogram->negative[i];
		if (histogram->negative[i] && (double)seen >= wanted)
			return within(histogram, -class_middle(i));
	}
	for (uint32_t i = 0; i < HISTOGRAM_HALF; i++) {
		seen += histogram->positive[i];
		if (histogram->positive[i] && (double)seen >= wanted)
			return within(histogram, class_middle(i));
	}
	return (double)histogram->most;
}

double histogram_mean(const struct histogram *histogram)
{
	return histogram->count ? histogram->sum / (double)histogram->count * 1e3 : 0.0;
}

double histogram_deviation(const struct histogram *histogram)
{
	const double count = (double)histogram->count;
	if (histogram->count < 2)
		return 0.0;
	const double variance = (histogram->square_sum - histogram->sum * histogram->sum / count) / (count - 1.0);
	return variance > 0.0 ? sqrt(variance) * 1e3 : 0.0;
}

uint64_t histogram_between(const struct histogram *histogram, double from_ns, double to_ns)
{
	uint64_t count = 0;
	for (uint32_t i = 0; i < HISTOGRAM_HALF; i++) {
		const double middle = class_middle(i);
		if (middle >= from_ns && middle < to_ns)
			count += histogram->positive[i];
		if (-middle >= from_ns && -middle < to_ns)
			count += histogram->negative[i];
	}
	return count;
}
