/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/measure/detail.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#define TAPS 5

double measure_tpsnr(const struct picture *before, const struct picture *now, const struct picture *truth_before,
					 const struct picture *truth_now)
{
	uint64_t sum = 0;
	assert(before->width == now->width && now->width == truth_now->width && truth_now->width == truth_before->width);
	assert(before->height == now->height && now->height == truth_now->height);
	for (uint32_t y = 0; y < now->height; y++) {
		const uint8_t *a = before->data + y * before->stride, *b = now->data + y * now->stride;
		const uint8_t *c = truth_before->data + y * truth_before->stride, *d = truth_now->data + y * truth_now->stride;
		for (uint32_t i = 0; i < 4 * now->width; i++) {
			const int difference = i % 4 == 3 ? 0 : (b[i] - a[i]) - (d[i] - c[i]);
			sum += (uint64_t)(difference * difference);
		}
	}
	if (sum == 0)
		return 100.0;
	const double mean = (double)sum / (3.0 * now->width * now->height);
	return fmin(100.0, 10.0 * log10(255.0 * 255.0 / mean));
}

static void luma_row(const struct picture *picture, uint32_t y, float *row)
{
	const uint8_t *pixel = picture->data + y * picture->stride;
	for (uint32_t x = 0; x < picture->width; x++, pixel += 4)
		row[x] = 0.299f * (float)pixel[2] + 0.587f * (float)pixel[1] + 0.114f * (float)pixel[0];
}

static uint32_t clamp_index(int64_t index, uint32_t count)
{
	return index < 0 ? 0 : index >= count ? count - 1 : (uint32_t)index;
}

/* Sums a row of five luma rows along y, then along x. */
static double row_energy(float *const rows[TAPS], float *low, uint32_t width)
{
	double sum = 0.0;
	for (uint32_t x = 0; x < width; x++)
		low[x] = (rows[0][x] + rows[4][x] + 4.0f * (rows[1][x] + rows[3][x]) + 6.0f * rows[2][x]) / 16.0f;
	for (uint32_t x = 0; x < width; x++) {
		const float far = low[clamp_index((int64_t)x - 2, width)] + low[clamp_index((int64_t)x + 2, width)];
		const float near = low[clamp_index((int64_t)x - 1, width)] + low[clamp_index((int64_t)x + 1, width)];
		const double high = (double)(rows[2][x] - (far + 4.0f * near + 6.0f * low[x]) / 16.0f);
		sum += high * high;
	}
	return sum;
}

double measure_high_frequency(const struct picture *picture)
{
	const uint32_t width = picture->width, height = picture->height;
	float *luma = malloc(sizeof(float) * width * height), *low = malloc(sizeof(float) * width);
	double sum = 0.0;
	for (uint32_t y = 0; luma && low && y < height; y++)
		luma_row(picture, y, luma + (size_t)y * width);
	for (uint32_t y = 0; luma && low && y < height; y++) {
		float *rows[TAPS];
		for (int tap = 0; tap < TAPS; tap++)
			rows[tap] = luma + (size_t)clamp_index((int64_t)y + tap - 2, height) * width;
		sum += row_energy(rows, low, width);
	}
	const double energy = luma && low ? sum / ((double)width * height) : (double)NAN;
	free(luma);
	free(low);
	return energy;
}
