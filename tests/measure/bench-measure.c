/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "daemon/measure/measure.h"

static double now_ms(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec * 1e3 + (double)t.tv_nsec / 1e6;
}

int main(void)
{
	const uint32_t width = 1920, height = 1080;
	uint8_t *a = malloc((size_t)width * height * 4), *b = malloc((size_t)width * height * 4);
	if (!a || !b)
		return 1;
	for (size_t i = 0; i < (size_t)width * height * 4; i++) {
		a[i] = (uint8_t)(i * 7 + i / 911);
		b[i] = (uint8_t)(a[i] + i % 5);
	}
	const struct picture p = {a, (size_t)width * 4, width, height}, q = {b, (size_t)width * 4, width, height};
	double psnr_ms = 1e9, ssim_ms = 1e9, sum = 0;
	for (int i = 0; i < 5; i++) {
		const double t0 = now_ms();
		sum += measure_psnr(&p, &q);
		const double t1 = now_ms();
		sum += measure_ssim(&p, &q);
		const double t2 = now_ms();
		psnr_ms = t1 - t0 < psnr_ms ? t1 - t0 : psnr_ms;
		ssim_ms = t2 - t1 < ssim_ms ? t2 - t1 : ssim_ms;
	}
	printf("measure_psnr 1920x1080 %.2f ms\nmeasure_ssim 1920x1080 %.2f ms\n", psnr_ms, ssim_ms);
	free(a);
	free(b);
	return sum > 0 ? 0 : 1;
}
