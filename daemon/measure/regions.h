/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Parts of a picture that are measured apart: what moves, and what was hidden
 * at the moment that an in-between frame is made from. Pure, any thread.
 */
#ifndef PURSUIT_MEASURE_REGIONS_H
#define PURSUIT_MEASURE_REGIONS_H

#include "measure.h"

/* Bits of a mask, one byte a pixel, packed rows. */
#define REGION_MOVING 1u /* displaced by a quarter of a pixel or more between the two moments */
#define REGION_HIDDEN 2u /* what the pixel shows is hidden, or outside the picture, at the other moment */

/* One moment as seen by the other: packed rows of width x height. */
struct region_view {
	const float *motion;       /* two a pixel: position at the OTHER moment minus position here; finite */
	const uint32_t *object_id; /* NULL: not known */
	const float *distance;     /* NULL: not known; any scale that grows with the distance from the eye */
};

/*
 * Exact regions of `here` with respect to `there`. A pixel is seen at the
 * other moment if one of the four pixels about the place to which its motion
 * leads is of the same object and leads back to within one pixel. Both views
 * need motion; object ids are used where both have them. With `here` the
 * moment of an in-between and `there` that of its real frame, REGION_HIDDEN is
 * what is disoccluded; the other way round, what becomes occluded.
 */
void regions_find(const struct region_view *here, const struct region_view *there, uint32_t width, uint32_t height,
				  uint8_t *mask);

/*
 * The approximation for streams that have motion one way only: a pixel counts
 * as hidden there if what is at that place there is nearer by more than a
 * tenth. `there` needs distance only, `here` motion and distance.
 */
void regions_guess(const struct region_view *here, const struct region_view *there, uint32_t width, uint32_t height,
				   uint8_t *mask);

/* Sum of squared errors over pixels chosen by some mask; starts zeroed. */
struct squared_error {
	double sum;
	uint64_t count; /* of pixels */
};

/* Adds the pixels in whose mask all of `bits` are set; mask NULL: all pixels. */
void squared_error_add(struct squared_error *error, const struct picture *a, const struct picture *b,
					   const uint8_t *mask, uint8_t bits);

/* As measure_psnr() over the pixels added; NAN if there were none. */
double squared_error_psnr(const struct squared_error *error);

/* Root of the mean squared error, code values 0 to 255; NAN if there were no pixels. */
double squared_error_root(const struct squared_error *error);

#endif
