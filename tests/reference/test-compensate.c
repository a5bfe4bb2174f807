/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The compensation of the reference (docs/method.md, 6): light over N vblanks
 * is kept, both range rules hold, the paper's formula comes out where no rule
 * acts, nothing leaves its range. All in double, before the rounding to 8 bits.
 */
#include <float.h>

#include "reference.h"
#include "tests/test.h"

static const double grid_values[] = {
	0.0,           4.9e-324,
	1e-310,        DBL_MIN,
	1e-30,         1e-12,
	1e-6,          1.0 / 255.0 / 12.92,
	0.001,         0.0031308,
	0.01,          0.04045,
	0.1,           0.18,
	0.25,          1.0 / 3,
	0.4999,        0.5,
	0.5001,        2.0 / 3,
	0.75,          0.875,
	0.9,           0.99,
	254.0 / 255.0, 1.0 - DBL_EPSILON,
	1.0,
};
#define VALUES (sizeof(grid_values) / sizeof(grid_values[0]))

static void check_split(double o, double l, uint32_t n)
{
	double b, e;
	reference_split(o, l, n, &b, &e);
	CHECK(b >= 0.0 && b <= 1.0);
	CHECK(e >= -1e-15 && e <= 1.0 + 1e-15 * n);
	CHECK_NEAR(((n - 1.0) * b + e) / n, o, 1e-6);
	CHECK_NEAR(((n - 1.0) * b + e) / n, o, 4e-15);
	CHECK(b <= o && e >= o - 1e-15 * n);
	if (n == 1)
		CHECK(b == o && e == o);
}

static void test_split_full_square(void)
{
	for (uint32_t n = 1; n <= 8; n++) {
		for (size_t i = 0; i < VALUES; i++)
			for (size_t j = 0; j < VALUES; j++)
				check_split(grid_values[i], grid_values[j], n);
		for (int i = 0; i <= 128; i++)
			for (int j = 0; j <= 128; j++)
				check_split(i / 128.0, j / 128.0, n);
		for (int i = 0; i <= 128; i++) {
			double b, e;
			reference_split(i / 128.0, i / 128.0, n, &b, &e);
			CHECK_NEAR(b, i / 128.0, 0.0);
			CHECK_NEAR(e, i / 128.0, 4e-15);
		}
	}
}

static void test_split_monotone(void)
{
	for (uint32_t n = 1; n <= 8; n++)
		for (int j = 0; j <= 64; j++) {
			double b0, e0;
			reference_split(0.0, j / 64.0, n, &b0, &e0);
			for (int i = 1; i <= 512; i++) {
				double b, e;
				reference_split(i / 512.0, j / 64.0, n, &b, &e);
				CHECK(b >= b0 && e >= e0 - 1e-14);
				b0 = b;
				e0 = e;
			}
		}
}

static struct reference_compensation make(double gamma, uint32_t n, double k)
{
	return (struct reference_compensation){
		.display = {gamma > 0.0 ? PURSUIT_CURVE_GAMMA : PURSUIT_CURVE_SRGB, gamma}, .n = n, .k = k};
}

/* 0 stands for sRGB. */
static const double gammas[] = {0.0, 1.0, 1.5, 2.0, 2.2, 2.4, 3.0, 4.0, 5.0};
#define GAMMAS (sizeof(gammas) / sizeof(gammas[0]))

static void check_pixel(const struct reference_compensation *how, double c, double low, double w)
{
	double between, real;
	reference_compensate(how, c, low, w, &between, &real);
	CHECK(between >= -1e-12 && between <= 1.0 + 1e-12);
	CHECK(real >= -1e-12 && real <= 1.0 + 1e-12);
	const double light =
		((how->n - 1.0) * reference_to_light(&how->display, between) + reference_to_light(&how->display, real)) /
		how->n;
	/* IEC 61966-2-1 rounds its constants, so its two pieces miss each other by 2e-8 in light. */
	CHECK_NEAR(light, reference_to_light(&how->display, c), 1e-6);
	if (w == 0.0)
		CHECK(between == c && real == c);
}

static void test_light_is_kept(void)
{
	static const double ks[] = {0.0, 0.3, 1.0}, ws[] = {0.0, 1e-9, 0.25, 0.5, 1.0};
	for (size_t g = 0; g < GAMMAS; g++)
		for (uint32_t n = 1; n <= 8; n++) {
			for (size_t i = 0; i < VALUES; i++)
				for (size_t j = 0; j < VALUES; j++) {
					const struct reference_compensation how = make(gammas[g], n, ks[(i + j) % 3]);
					check_pixel(&how, grid_values[i], grid_values[j], ws[(3 * i + j) % 5]);
				}
			const struct reference_compensation how = make(gammas[g], n, 1.0);
			for (int c = 0; c <= 255; c += 5)
				for (int low = 0; low <= 255; low += 5)
					check_pixel(&how, c / 255.0, low / 255.0, 1.0);
		}
}

/* H^ = (N (H + L)^gamma - (N - 1) L^gamma)^(1/gamma) - L (Didyk et al. 2010, 5.1). */
static void test_paper_formula(void)
{
	int used = 0;
	for (size_t g = 1; g < GAMMAS; g++)
		for (uint32_t n = 2; n <= 8; n++)
			for (int c = 0; c <= 100; c++)
				for (int low = 0; low <= c; low++) {
					const double original = c / 100.0, l = low / 100.0, gamma = gammas[g];
					const double over = n * pow(original, gamma) - (n - 1.0) * pow(l, gamma);
					const struct reference_compensation how = make(gamma, n, 1.0);
					double between, real;
					if (over > 1.0)
						continue;
					reference_compensate(&how, original, l, 1.0, &between, &real);
					CHECK_NEAR(between, l, 1e-12);
					const double detail = pow(over, 1.0 / gamma) - l;
					CHECK_NEAR(real - l, detail, 1e-9);
					used++;
				}
	CHECK(used > 10000);
}

/* Gamma 1: H^ = N H, a simple scaling. */
static void test_linear_scales_detail(void)
{
	const struct reference_compensation how = make(1.0, 3, 1.0);
	double between, real;
	reference_compensate(&how, 0.5, 0.4, 1.0, &between, &real);
	CHECK_NEAR(between, 0.4, 1e-15);
	CHECK_NEAR(real, 0.4 + 3 * 0.1, 1e-15);
}

static void test_range_rules(void)
{
	double b, e;
	/* Darker than its surroundings: keep the original in all frames. */
	reference_split(0.2, 0.6, 2, &b, &e);
	CHECK_NEAR(b, 0.2, 1e-15);
	CHECK_NEAR(e, 0.2, 1e-15);
	/* N = 2, o = 0.8, l = 0.3: 1.3 would be needed; 0.3 too much moves into the in-between. */
	reference_split(0.8, 0.3, 2, &b, &e);
	CHECK_NEAR(b, 0.6, 1e-15);
	CHECK_NEAR(e, 1.0, 1e-15);
	/* N = 4, o = 0.9, l = 0: b = (3.6 - 1)/3. */
	reference_split(0.9, 0.0, 4, &b, &e);
	CHECK_NEAR(b, 2.6 / 3.0, 1e-15);
	CHECK_NEAR(e, 1.0, 1e-15);
	/* White stays white, black stays black. */
	reference_split(1.0, 0.0, 8, &b, &e);
	CHECK_NEAR(b, 1.0, 1e-15);
	CHECK_NEAR(e, 1.0, 1e-14);
	reference_split(0.0, 1.0, 8, &b, &e);
	CHECK(b == 0.0 && e == 0.0);
	/* In range: N = 2, o = 0.4, l = 0.3. */
	reference_split(0.4, 0.3, 2, &b, &e);
	CHECK_NEAR(b, 0.3, 1e-15);
	CHECK_NEAR(e, 0.5, 1e-15);
}

static void test_srgb_by_hand(void)
{
	/* c = 0.5: o = 0.214041; L = 0.4: l = 0.132868; N = 2: e = 0.295214, from_light = 0.580399. */
	const struct reference_compensation how = make(0.0, 2, 1.0);
	double between, real;
	reference_compensate(&how, 0.5, 0.4, 1.0, &between, &real);
	CHECK_NEAR(between, 0.4, 1e-12);
	CHECK_NEAR(reference_to_light(&how.display, real), 0.295214, 1e-6);
	CHECK_NEAR(real, 1.055 * pow(0.295214, 1.0 / 2.4) - 0.055, 1e-5);
	/* Half the weight: the in-between shows the mix 0.45. */
	reference_compensate(&how, 0.5, 0.4, 0.5, &between, &real);
	CHECK_NEAR(between, 0.45, 1e-12);
}

static void test_off_and_slow(void)
{
	struct reference_compensation how = make(2.2, 3, 0.0);
	double between, real;
	/* Bloch's law has ended: what is split no longer adds up, so nothing is split. */
	reference_compensate(&how, 0.5, 0.2, 1.0, &between, &real);
	CHECK_NEAR(between, 0.5, 1e-12);
	CHECK_NEAR(real, 0.5, 1e-12);
	how.off = true;
	reference_compensate(&how, 0.5, 0.2, 0.5, &between, &real);
	CHECK_NEAR(between, 0.35, 1e-12);
	CHECK(real == 0.5);
	CHECK_NEAR(1.0 - reference_smoothstep(0.030, 0.050, 0.025), 1.0, 0.0);
	CHECK_NEAR(1.0 - reference_smoothstep(0.030, 0.050, 0.040), 0.5, 1e-12);
	CHECK_NEAR(1.0 - reference_smoothstep(0.030, 0.050, 0.050), 0.0, 0.0);
}

int main(void)
{
	RUN(test_split_full_square);
	RUN(test_split_monotone);
	RUN(test_light_is_kept);
	RUN(test_paper_formula);
	RUN(test_linear_scales_detail);
	RUN(test_range_rules);
	RUN(test_srgb_by_hand);
	RUN(test_off_and_slow);
	return test_result();
}
