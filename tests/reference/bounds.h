/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What a displayed picture of the engine may be, given that it computes in
 * float, rounds planes to 8 bits and draws with a GL rasteriser. Instead of one
 * loose number for all pixels, each pixel gets its own interval from the
 * reference; a pixel outside it is an error, with no share of errors allowed.
 *
 * Why a pixel may differ, and by how much:
 *
 *  - Rounding to 8 bits of a number near a half. The planes L, B and E are
 *    computed twice, with all roundings pushed down and up by BOUNDS_ROUNDING,
 *    so that a half moves a step and what is clear does not move at all. This
 *    runs through the pyramid, the spline and the compensation, which makes N
 *    steps of one.
 *  - GL rasterisers (llvmpipe and hardware alike) keep positions to 1/256 pixel:
 *    a corner moves by up to 1/512 in x and in y. So the source position is off
 *    by BOUNDS_SUBPIXEL divided by the smaller singular value of the triangle's
 *    map, and within BOUNDS_EDGE of an edge the neighbour may be drawn: then
 *    the pixel may show what any of the candidates shows.
 *  - Bilinear weights have 8 bits (the least that Direct3D and Vulkan demand;
 *    llvmpipe has just these for 8-bit textures): BOUNDS_WEIGHT pixels of
 *    source position.
 *  - llvmpipe filters 8-bit textures in 8 bits: each of its two interpolations
 *    (along, then across) is rounded, then the mix of samples is rounded for the
 *    display: BOUNDS_STEP, three times half a step.
 *  - Depth has 24 bits or more and is interpolated in float: two triangles that
 *    close (BOUNDS_DEPTH) at a pixel may be ordered either way. Without a depth
 *    plane all have one depth exactly, and the first in drawing order must show.
 *  - A pixel centre that lies on a shared edge in source coordinates belongs to
 *    one of the two triangles, by a rule that GL leaves open: w between both.
 *  - A quad whose diagonal, or a vertex whose snapping, float may choose the
 *    other way (reference.h, `either`): both diagonals are candidates; pixels of
 *    an undecided vertex are excused and counted.
 */
#ifndef PURSUIT_REFERENCE_BOUNDS_H
#define PURSUIT_REFERENCE_BOUNDS_H

#include "reference.h"

#define BOUNDS_ROUNDING 0.02
#define BOUNDS_SUBPIXEL (1.0 / 256.0)
#define BOUNDS_EDGE (1.0 / 128.0)
#define BOUNDS_WEIGHT (1.0 / 256.0)
#define BOUNDS_STEP 1.5
#define BOUNDS_DEPTH 4e-6
#define BOUNDS_STRETCH 1e-4

/* A triangle that may be drawn: those of the grid, and those of the other diagonal where that is open. */
struct bounds_triangle {
	uint32_t v[3];
	bool certain; /* drawn for sure */
	bool excused; /* a vertex is undecided */
};

struct bounds {
	const struct reference *reference;
	uint32_t triangle_count;
	struct bounds_triangle *triangles;
	struct reference_picture low[2], between[2], real[2]; /* least, most */
};

/* `reference` begun; it must outlive the bounds. */
void bounds_init(struct bounds *bounds, const struct reference *reference);
void bounds_finish(struct bounds *bounds);

/* Counts over pixels (all three channels must fit); sums up over calls. */
struct bounds_report {
	uint64_t pixels;
	uint64_t same, within_one, within_two; /* |engine - reference| of the worst channel: 0, <= 1, <= 2 */
	uint64_t sharp; /* one candidate, and no interval wider than 4 steps: what keeps the test honest */
	uint64_t plain, plain_within_one; /* one candidate, L, E, B certain, gradient below 16 steps a pixel */
	uint64_t other;                   /* fits a candidate other than the nominal triangle only */
	uint64_t excused;                 /* shows an undecided vertex */
	uint64_t outside;                 /* errors */
	double worst;                     /* steps outside the interval, and where */
	uint32_t worst_x, worst_y;
	uint8_t worst_got[3], worst_want[3];
};

/* Compares a displayed picture (BGRA8, stride bytes a row) with what may be shown for the request. */
void bounds_compare(const struct bounds *bounds, const struct engine_request *request, const uint8_t *pixels,
					size_t stride, struct bounds_report *report);

#endif
