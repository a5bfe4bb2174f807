/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Is the light of the original kept? Didyk et al. 2010, Sections 2 and 5.1:
 * the pictures shown for one real frame add up in the eye (Bloch's law), so
 * their mean along the true motion should be the light of the original.
 *
 * Pure, any thread.
 */
#ifndef PURSUIT_MEASURE_ENERGY_H
#define PURSUIT_MEASURE_ENERGY_H

#include "light.h"

/* Local: errors are of means over blocks of this many pixels a side, so that resampling of texture does not count. */
#define ENERGY_BLOCK 8u

/* One of the N pictures shown for a real frame. */
struct energy_picture {
	const light_pixel *light;
	const float *motion;   /* two a pixel of the real frame: place in this picture minus place there; NULL: all 0 */
	const uint8_t *hidden; /* pixels of the real frame with a bit of hidden_bits are not seen here; NULL: all are */
	uint8_t hidden_bits;
};

/* Over blocks; starts zeroed. */
struct energy_error {
	double squares; /* of (mean light - original), three channels */
	double signed_sum;
	double light; /* of the original */
	uint64_t count;
};

/* Adds the whole blocks of a real frame all of whose pixels are seen in all pictures. */
void energy_error_add(struct energy_error *error, const light_pixel *original, const struct energy_picture *pictures,
					  uint32_t count, uint32_t width, uint32_t height);

/* Root mean square of the error as a share of the mean light; NAN if nothing was added or all is dark. */
double energy_error_root(const struct energy_error *error);

/* Mean of the signed error as a share of the mean light: light gained (+) or lost (-). */
double energy_error_bias(const struct energy_error *error);

#endif
