/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/histogram.h"
#include "tests/test.h"

static void test_empty(void)
{
	static struct histogram histogram;
	CHECK_NEAR(histogram_percentile(&histogram, 0.5), 0, 0);
	CHECK_NEAR(histogram_mean(&histogram), 0, 0);
	CHECK_NEAR(histogram_deviation(&histogram), 0, 0);
}

static void test_every_size(void)
{
	for (double span = 1; span < 3.6e12; span *= 1.37) {
		static struct histogram histogram;
		histogram = (struct histogram){0};
		histogram_add(&histogram, 0);
		histogram_add(&histogram, (int64_t)span);
		histogram_add(&histogram, 2 * (int64_t)span);
		CHECK_NEAR(histogram_percentile(&histogram, 0.5), floor(span), span * 0.004);
		CHECK_NEAR(histogram_percentile(&histogram, 0.0), 0, 0);
	}
}

static void test_percentiles(void)
{
	static struct histogram histogram;
	histogram = (struct histogram){0};
	for (int64_t i = 1; i <= 100000; i++)
		histogram_add(&histogram, i * 100);
	CHECK_NEAR(histogram_percentile(&histogram, 0.50), 5e6, 2e4);
	CHECK_NEAR(histogram_percentile(&histogram, 0.99), 9.9e6, 4e4);
	CHECK_NEAR(histogram_percentile(&histogram, 1.0), 1e7, 0);
	CHECK_NEAR(histogram_mean(&histogram), 5000050, 1);
	CHECK_NEAR(histogram_deviation(&histogram), 1e7 / sqrt(12), 100);
	CHECK_INT(histogram.least, 100);
	CHECK_INT(histogram.most, 10000000);
	CHECK_INT(histogram_between(&histogram, 0, 1e12), 100000);
	CHECK_NEAR((double)histogram_between(&histogram, 2e6, 4e6), 20000, 200);
}

static void test_below_zero(void)
{
	static struct histogram histogram;
	histogram = (struct histogram){0};
	for (int64_t i = -500; i <= 500; i++)
		histogram_add(&histogram, i * 1000);
	CHECK_NEAR(histogram_percentile(&histogram, 0.5), 0, 4000);
	CHECK_NEAR(histogram_percentile(&histogram, 0.1), -400000, 2000);
	CHECK_NEAR(histogram_mean(&histogram), 0, 1e-6);
	CHECK_INT(histogram.least, -500000);
	CHECK_NEAR((double)histogram_between(&histogram, -1e6, 0), 500, 0);
}

static void test_absurd(void)
{
	static struct histogram histogram;
	histogram = (struct histogram){0};
	histogram_add(&histogram, INT64_MAX);
	histogram_add(&histogram, INT64_MIN);
	CHECK_INT(histogram.most, HISTOGRAM_LIMIT_NS);
	CHECK_INT(histogram.least, -HISTOGRAM_LIMIT_NS);
	CHECK_INT(histogram.count, 2);
}

static void test_merge(void)
{
	static struct histogram a, b, both;
	for (int64_t i = 0; i < 1000; i++) {
		histogram_add(i % 3 ? &a : &b, i * i - 5000);
		histogram_add(&both, i * i - 5000);
	}
	histogram_merge(&a, &b);
	CHECK_INT(memcmp(a.positive, both.positive, sizeof(a.positive)), 0);
	CHECK_INT(memcmp(a.negative, both.negative, sizeof(a.negative)), 0);
	CHECK_INT(a.count, 1000);
	CHECK_INT(a.least, both.least);
	CHECK_INT(a.most, both.most);
	CHECK_NEAR(histogram_mean(&a), histogram_mean(&both), 1e-6);
}

int main(void)
{
	RUN(test_empty);
	RUN(test_every_size);
	RUN(test_percentiles);
	RUN(test_below_zero);
	RUN(test_absurd);
	RUN(test_merge);
	return test_result();
}
