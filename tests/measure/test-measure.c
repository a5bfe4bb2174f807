/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/measure/measure.h"
#include "tests/test.h"

/* A picture of its own memory, rows further apart than they need to be. */
static struct picture make(uint32_t width, uint32_t height)
{
	const size_t stride = (size_t)width * 4 + 12;
	return (struct picture){calloc(height, stride), stride, width, height};
}

static uint8_t *pixel(const struct picture *picture, uint32_t x, uint32_t y)
{
	return (uint8_t *)(uintptr_t)picture->data + y * picture->stride + 4 * (size_t)x;
}

static void destroy(struct picture *picture)
{
	free(pixel(picture, 0, 0));
}

static uint32_t random_next(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	return *state >> 24;
}

static struct picture make_noise(uint32_t width, uint32_t height, uint32_t seed, uint32_t strength)
{
	struct picture picture = make(width, height);
	for (uint32_t y = 0; y < height; y++)
		for (uint32_t x = 0; x < width; x++)
			for (uint32_t c = 0; c < 4; c++)
				pixel(&picture, x, y)[c] = (uint8_t)((x * 3 + y * 5 + c * 40 + random_next(&seed) % strength) & 0xff);
	return picture;
}

/* SSIM from the definition: a two-dimensional window and variances about the mean, at every position. */
static double naive_ssim(const struct picture *a, const struct picture *b)
{
	const uint32_t nx = a->width < 11 ? a->width : 11, ny = a->height < 11 ? a->height : 11;
	double weights[11][11], total = 0.0, sum = 0.0;
	for (uint32_t j = 0; j < ny; j++)
		for (uint32_t i = 0; i < nx; i++) {
			const double dx = i - (nx - 1) / 2.0, dy = j - (ny - 1) / 2.0;
			weights[j][i] = exp(-(dx * dx + dy * dy) / (2.0 * 1.5 * 1.5));
			total += weights[j][i];
		}
	for (uint32_t y = 0; y + ny <= a->height; y++)
		for (uint32_t x = 0; x + nx <= a->width; x++) {
			double ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
			for (int pass = 0; pass < 2; pass++)
				for (uint32_t j = 0; j < ny; j++)
					for (uint32_t i = 0; i < nx; i++) {
						const uint8_t *p = pixel(a, x + i, y + j), *q = pixel(b, x + i, y + j);
						const double la = 0.299 * p[2] + 0.587 * p[1] + 0.114 * p[0];
						const double lb = 0.299 * q[2] + 0.587 * q[1] + 0.114 * q[0];
						const double w = weights[j][i] / total;
						if (pass == 0) {
							ma += w * la;
							mb += w * lb;
						} else {
							va += w * (la - ma) * (la - ma);
							vb += w * (lb - mb) * (lb - mb);
							cov += w * (la - ma) * (lb - mb);
						}
					}
			const double c1 = 6.5025, c2 = 58.5225;
			sum += (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
		}
	return sum / ((a->width - nx + 1.0) * (a->height - ny + 1.0));
}

static void test_identical(void)
{
	struct picture a = make_noise(37, 29, 1, 90), b = make_noise(37, 29, 1, 90);
	CHECK(measure_psnr(&a, &b) == 100.0);
	CHECK(measure_ssim(&a, &b) == 1.0);
	destroy(&a);
	destroy(&b);
}

static void test_alpha_is_ignored(void)
{
	struct picture a = make_noise(16, 16, 1, 90), b = make_noise(16, 16, 1, 90);
	for (uint32_t y = 0; y < 16; y++)
		for (uint32_t x = 0; x < 16; x++)
			pixel(&b, x, y)[3] ^= 0xff;
	CHECK(measure_psnr(&a, &b) == 100.0);
	CHECK(measure_ssim(&a, &b) == 1.0);
	destroy(&a);
	destroy(&b);
}

static void test_psnr_by_hand(void)
{
	struct picture a = make(10, 10), b = make(10, 10);
	pixel(&b, 3, 4)[1] = 255; /* one of 300 values: 10 log10(300) */
	CHECK_NEAR(measure_psnr(&a, &b), 24.771212547, 1e-8);
	pixel(&b, 3, 4)[1] = 1; /* 10 log10(255^2 x 300) */
	CHECK_NEAR(measure_psnr(&a, &b), 72.902015, 1e-5);
	for (uint32_t y = 0; y < 10; y++)
		for (uint32_t x = 0; x < 10; x++)
			for (int c = 0; c < 3; c++)
				pixel(&b, x, y)[c] = 255;
	CHECK_NEAR(measure_psnr(&a, &b), 0.0, 1e-12);
	destroy(&a);
	destroy(&b);
}

static void test_psnr_never_above_100(void)
{
	/* One step in 16384 x 64 pixels would be 113 dB. */
	struct picture a = make(16384, 64), b = make(16384, 64);
	pixel(&b, 16383, 63)[2] = 1;
	CHECK(measure_psnr(&a, &b) == 100.0);
	destroy(&a);
	destroy(&b);
}

static void test_ssim_by_hand(void)
{
	/* Flat grey 100 against flat grey 150: only the luminance term, (2 ab + C1) / (a^2 + b^2 + C1). */
	struct picture a = make(20, 20), b = make(20, 20);
	for (uint32_t y = 0; y < 20; y++)
		for (uint32_t x = 0; x < 20; x++)
			for (int c = 0; c < 3; c++) {
				pixel(&a, x, y)[c] = 100;
				pixel(&b, x, y)[c] = 150;
			}
	CHECK_NEAR(measure_ssim(&a, &b), (2.0 * 100 * 150 + 6.5025) / (100.0 * 100 + 150.0 * 150 + 6.5025), 1e-9);
	destroy(&a);
	destroy(&b);
}

static void test_ssim_against_definition(void)
{
	static const uint32_t sizes[][2] = {{11, 11}, {12, 11}, {40, 31}, {1, 1}, {5, 40}, {40, 5}, {10, 10}, {2, 3}};
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		struct picture a = make_noise(sizes[i][0], sizes[i][1], 7, 60);
		struct picture b = make_noise(sizes[i][0], sizes[i][1], 8, 120);
		CHECK_NEAR(measure_ssim(&a, &b), naive_ssim(&a, &b), 1e-10);
		CHECK(measure_ssim(&a, &b) == measure_ssim(&a, &b));
		CHECK_NEAR(measure_ssim(&a, &b), measure_ssim(&b, &a), 1e-12);
		destroy(&a);
		destroy(&b);
	}
}

static void test_quality(void)
{
	struct picture a = make(10, 10), b = make(10, 10);
	struct quality q = {0};
	quality_add(&q, &a, &b);
	CHECK_NEAR(q.psnr, 100.0, 0);
	CHECK_NEAR(q.psnr_min, 100.0, 0);
	pixel(&b, 3, 4)[1] = 255;
	const double ssim = measure_ssim(&a, &b);
	quality_add(&q, &a, &b);
	CHECK_INT(q.frames, 2);
	CHECK_NEAR(q.psnr, (100.0 + 24.771212547) / 2, 1e-8);
	CHECK_NEAR(q.psnr_min, 24.771212547, 1e-8);
	CHECK_NEAR(q.ssim, (1.0 + ssim) / 2, 1e-12);
	destroy(&a);
	destroy(&b);
}

int main(void)
{
	RUN(test_identical);
	RUN(test_alpha_is_ignored);
	RUN(test_psnr_by_hand);
	RUN(test_psnr_never_above_100);
	RUN(test_ssim_by_hand);
	RUN(test_ssim_against_definition);
	RUN(test_quality);
	return test_result();
}
