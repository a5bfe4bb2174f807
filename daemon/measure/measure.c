/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/measure/measure.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#define WINDOW 11u
#define SIGMA 1.5
/* Wang et al. 2004: C1 = (K1 L)^2, C2 = (K2 L)^2. */
#define C1 (0.01 * 255.0 * 0.01 * 255.0)
#define C2 (0.03 * 255.0 * 0.03 * 255.0)

static void assert_same_size(const struct picture *a, const struct picture *b)
{
	assert(a->width > 0 && a->height > 0);
	assert(a->width == b->width && a->height == b->height);
	(void)a;
	(void)b;
}

double measure_psnr(const struct picture *a, const struct picture *b)
{
	uint64_t sum = 0;
	assert_same_size(a, b);
	for (uint32_t y = 0; y < a->height; y++) {
		const uint8_t *p = a->data + y * a->stride, *q = b->data + y * b->stride;
		for (uint32_t x = 0; x < a->width; x++, p += 4, q += 4) {
			const int blue = p[0] - q[0], green = p[1] - q[1], red = p[2] - q[2];
			sum += (uint64_t)(blue * blue + green * green + red * red);
		}
	}
	if (sum == 0)
		return 100.0;
	const double mean = (double)sum / (3.0 * a->width * a->height);
	return fmin(100.0, 10.0 * log10(255.0 * 255.0 / mean));
}

/* The four quantities that SSIM averages; variances are needed only as their sum. */
enum { MEAN_A, MEAN_B, SQUARES, PRODUCT, QUANTITIES };

/*
 * The window is separable. Each row is filtered along x once, into a ring of
 * the last `taps_y` rows; each output row then sums over the ring.
 */
struct ssim {
	uint32_t width, height; /* of the picture */
	uint32_t taps_x, taps_y;
	uint32_t columns; /* positions of the window along x */
	double weights_x[WINDOW], weights_y[WINDOW];
	double *raw;  /* QUANTITIES rows of `width` */
	double *ring; /* taps_y x QUANTITIES rows of `columns` */
	double *sums; /* QUANTITIES rows of `columns` */
};

static uint32_t window_weights(uint32_t size, double weights[WINDOW])
{
	const uint32_t taps = size < WINDOW ? size : WINDOW;
	const double middle = (taps - 1) / 2.0;
	double sum = 0.0;
	for (uint32_t i = 0; i < taps; i++) {
		weights[i] = exp(-(i - middle) * (i - middle) / (2.0 * SIGMA * SIGMA));
		sum += weights[i];
	}
	for (uint32_t i = 0; i < taps; i++)
		weights[i] /= sum;
	return taps;
}

static bool ssim_init(struct ssim *s, uint32_t width, uint32_t height)
{
	*s = (struct ssim){.width = width, .height = height};
	s->taps_x = window_weights(width, s->weights_x);
	s->taps_y = window_weights(height, s->weights_y);
	s->columns = width - s->taps_x + 1;
	s->raw = malloc(sizeof(double) * QUANTITIES * width);
	s->ring = malloc(sizeof(double) * QUANTITIES * s->taps_y * s->columns);
	s->sums = malloc(sizeof(double) * QUANTITIES * s->columns);
	return s->raw && s->ring && s->sums;
}

static void ssim_finish(struct ssim *s)
{
	free(s->raw);
	free(s->ring);
	free(s->sums);
}

static double luma(const uint8_t *bgra)
{
	return 0.299 * bgra[2] + 0.587 * bgra[1] + 0.114 * bgra[0];
}

static void filter_x(const double *restrict in, double *restrict out, uint32_t columns, uint32_t taps,
					 const double *restrict weights)
{
	if (taps == WINDOW) {
		for (uint32_t x = 0; x < columns; x++)
			out[x] = (in[x] + in[x + 10]) * weights[0] + (in[x + 1] + in[x + 9]) * weights[1] +
					 (in[x + 2] + in[x + 8]) * weights[2] + (in[x + 3] + in[x + 7]) * weights[3] +
					 (in[x + 4] + in[x + 6]) * weights[4] + in[x + 5] * weights[5];
		return;
	}
	for (uint32_t x = 0; x < columns; x++) {
		double sum = 0.0;
		for (uint32_t i = 0; i < taps; i++)
			sum += in[x + i] * weights[i];
		out[x] = sum;
	}
}

/* Reads row y of both pictures and puts its four filtered quantities into the ring. */
static void ring_push(struct ssim *s, const struct picture *a, const struct picture *b, uint32_t y)
{
	const uint8_t *p = a->data + y * a->stride, *q = b->data + y * b->stride;
	double *restrict raw = s->raw;
	const size_t width = s->width;
	for (size_t x = 0; x < width; x++) {
		const double la = luma(p + 4 * x), lb = luma(q + 4 * x);
		raw[MEAN_A * width + x] = la;
		raw[MEAN_B * width + x] = lb;
		raw[SQUARES * width + x] = la * la + lb * lb;
		raw[PRODUCT * width + x] = la * lb;
	}
	double *slot = s->ring + (size_t)(y % s->taps_y) * QUANTITIES * s->columns;
	for (size_t i = 0; i < QUANTITIES; i++)
		filter_x(raw + i * width, slot + i * s->columns, s->columns, s->taps_x, s->weights_x);
}

/* Sums the ring along y, for the window whose first row is `top`; rows are added in picture order. */
static void filter_y(struct ssim *s, uint32_t top)
{
	const size_t count = (size_t)QUANTITIES * s->columns;
	const double *rows[WINDOW];
	double *restrict sums = s->sums;
	for (uint32_t i = 0; i < s->taps_y; i++)
		rows[i] = s->ring + (top + i) % s->taps_y * count;
	if (s->taps_y == WINDOW) {
		const double *w = s->weights_y;
		for (size_t x = 0; x < count; x++)
			sums[x] = (rows[0][x] + rows[10][x]) * w[0] + (rows[1][x] + rows[9][x]) * w[1] +
					  (rows[2][x] + rows[8][x]) * w[2] + (rows[3][x] + rows[7][x]) * w[3] +
					  (rows[4][x] + rows[6][x]) * w[4] + rows[5][x] * w[5];
		return;
	}
	for (size_t x = 0; x < count; x++) {
		double sum = 0.0;
		for (uint32_t i = 0; i < s->taps_y; i++)
			sum += rows[i][x] * s->weights_y[i];
		sums[x] = sum;
	}
}

static double row_ssim(const struct ssim *s)
{
	const double *mean_a = s->sums + (size_t)MEAN_A * s->columns, *mean_b = s->sums + (size_t)MEAN_B * s->columns;
	const double *squares = s->sums + (size_t)SQUARES * s->columns, *product = s->sums + (size_t)PRODUCT * s->columns;
	double sum = 0.0;
	for (uint32_t x = 0; x < s->columns; x++) {
		const double ab = mean_a[x] * mean_b[x], aa_bb = mean_a[x] * mean_a[x] + mean_b[x] * mean_b[x];
		const double variances = squares[x] - aa_bb, covariance = product[x] - ab;
		sum += (2.0 * ab + C1) * (2.0 * covariance + C2) / ((aa_bb + C1) * (variances + C2));
	}
	return sum;
}

double measure_ssim(const struct picture *a, const struct picture *b)
{
	struct ssim s;
	double sum = 0.0;
	assert_same_size(a, b);
	if (!ssim_init(&s, a->width, a->height)) {
		ssim_finish(&s);
		return NAN;
	}
	for (uint32_t y = 0; y < a->height; y++) {
		ring_push(&s, a, b, y);
		if (y + 1 < s.taps_y)
			continue;
		filter_y(&s, y + 1 - s.taps_y);
		sum += row_ssim(&s);
	}
	sum /= (double)s.columns * (a->height - s.taps_y + 1);
	ssim_finish(&s);
	return sum;
}

void quality_add(struct quality *q, const struct picture *shown, const struct picture *truth)
{
	const double psnr = measure_psnr(shown, truth), ssim = measure_ssim(shown, truth);
	q->frames++;
	q->psnr += (psnr - q->psnr) / q->frames;
	q->ssim += (ssim - q->ssim) / q->frames;
	if (q->frames == 1 || psnr < q->psnr_min)
		q->psnr_min = psnr;
}
