/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Error measures between pictures. Knows no GL, no socket and no clock.
 * A picture: BGRA8, rows top to bottom, stride in bytes; alpha is ignored.
 */
#ifndef PURSUIT_MEASURE_H
#define PURSUIT_MEASURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct picture {
	const uint8_t *data;
	size_t stride;
	uint32_t width;
	uint32_t height;
};

/*
 * Peak signal-to-noise ratio, dB, on 8-bit R, G, B: 10 log10(255^2 / mean
 * squared error); 100 where the pictures are identical, and never more.
 * Both pictures have the same size (asserted).
 */
double measure_psnr(const struct picture *a, const struct picture *b);

/*
 * Structural similarity, Wang et al. 2004: on Rec. 601 luma, 11x11 Gaussian
 * window of standard deviation 1.5, K1 = 0.01, K2 = 0.03, L = 255, mean over
 * the positions where the window fits. In a direction where the picture has
 * n < 11 pixels the window has n taps, centred on the picture, and is
 * normalised again. Identical pictures give 1. NAN only if out of memory.
 */
double measure_ssim(const struct picture *a, const struct picture *b);

/* Means over frames and how many there were. */
struct quality {
	uint32_t frames;
	double psnr;
	double ssim;
	double psnr_min;
};

/* Adds one in-between and its truth to the means; q starts zeroed. */
void quality_add(struct quality *q, const struct picture *shown, const struct picture *truth);

#endif
