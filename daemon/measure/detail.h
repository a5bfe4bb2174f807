/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Flicker and detail, from pictures alone. Pure, any thread. */
#ifndef PURSUIT_MEASURE_DETAIL_H
#define PURSUIT_MEASURE_DETAIL_H

#include "measure.h"

/*
 * tPSNR: PSNR of the change from one displayed picture to the next against the
 * change of the truth, (now - before) - (truth_now - truth_before) per channel
 * in code values, with the peak of the pictures (255). What flickers has a low
 * one even where each picture alone is near its truth; a constant error has
 * none. 100 where the changes are identical. All of one size (asserted).
 */
double measure_tpsnr(const struct picture *before, const struct picture *now, const struct picture *truth_before,
					 const struct picture *truth_now);

/*
 * High-frequency energy: mean square of what a binomial low-pass (1 4 6 4 1)^2
 * / 256 takes away, of Rec. 601 luma in code values, clamped at the edge: the
 * first Laplacian level of Burt and Adelson 1983. The ratio of in-between to
 * real frames says how much detail comes and goes (Didyk et al. 2010, Section
 * 5.1, gives the detail of the in-betweens to the real frames). NAN only if
 * out of memory.
 */
double measure_high_frequency(const struct picture *picture);

#endif
