/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The methods that work pixel by pixel, in double precision, written from
 * docs/method.md, 9. Pictures come as B G R in steps (0 to 255), not rounded,
 * three numbers a pixel, with a mark where float may have decided otherwise.
 */
#ifndef PURSUIT_REFERENCE_PIXELS_H
#define PURSUIT_REFERENCE_PIXELS_H

#include "reference.h"

/* How near to a boundary of a decision float and double may part, pixels; and of depth. */
#define PIXELS_OPEN 2e-4
#define PIXELS_OPEN_DEPTH 4e-7

struct reference_steps {
	uint32_t width, height;
	double *values; /* 3 a pixel */
	uint8_t *open;  /* a byte a pixel: another decision is as good */
};

void reference_steps_init(struct reference_steps *steps, uint32_t width, uint32_t height);
void reference_steps_finish(struct reference_steps *steps);

/* [9.5, 1] index of the source pixel of each target, -1: hole; open[]: may be another, or a hole, or none. */
void reference_scatter(const struct reference_geometry *geometry, double phase, int64_t *source, uint8_t *open);

/* [9.5, 3] holes (valid 0) of a plane of `channels` numbers a pixel, in place. */
void reference_fill(double *values, const uint8_t *valid, uint32_t width, uint32_t height, uint32_t channels);

/* [9.4] */
void reference_mcif(const struct reference_geometry *geometry, const struct reference_picture *original,
					struct reference_steps *out);

/* [9.5] at a phase, displaced. */
void reference_scattered(const struct reference_geometry *geometry, const struct reference_picture *original,
						 double phase, struct reference_steps *out);

/* [9.6] at a share between 0 and 1; `geometry` and `original` of the frame begun last. */
void reference_interpolated(const struct reference_geometry *geometry, const struct reference_picture *original,
							const struct reference_geometry *before, const struct reference_picture *previous,
							double share, struct reference_steps *out);

#endif
