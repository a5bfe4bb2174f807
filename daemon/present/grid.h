/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The grid of a display's vblanks: vblank k is at
 *   epoch_ns + floor((k - epoch_vblank) x 1e9 x denominator / numerator).
 * It does not drift: 8,333,333 ns and the rest, not 8 ms. A grid that is learned
 * (vblanks.h) moves its epoch along; vblanks before the epoch have times too.
 */
#ifndef PURSUIT_GRID_H
#define PURSUIT_GRID_H

#include <stdint.h>

struct grid {
	uint64_t numerator; /* Hz = numerator / denominator */
	uint64_t denominator;
	uint64_t epoch_ns; /* of vblank epoch_vblank */
	uint64_t epoch_vblank;
	uint64_t doubt_ppb; /* of the period, if learned: three standard deviations, in parts of 1e9; 0: exact */
};

__extension__ typedef unsigned __int128 grid_wide;

/* Not before 0, whatever the vblank. */
static inline uint64_t grid_time(const struct grid *grid, uint64_t vblank)
{
	const grid_wide period = (grid_wide)UINT64_C(1000000000) * grid->denominator;
	if (vblank >= grid->epoch_vblank)
		return grid->epoch_ns + (uint64_t)((vblank - grid->epoch_vblank) * period / grid->numerator);
	const grid_wide before = ((grid->epoch_vblank - vblank) * period + grid->numerator - 1) / grid->numerator;
	return before < grid->epoch_ns ? grid->epoch_ns - (uint64_t)before : 0;
}

/* The first vblank that is not before time_ns. For a whole d, floor(k x) >= d is k x >= d. */
static inline uint64_t grid_at_or_after(const struct grid *grid, uint64_t time_ns)
{
	const grid_wide period = (grid_wide)UINT64_C(1000000000) * grid->denominator;
	if (time_ns > grid->epoch_ns)
		return grid->epoch_vblank +
			   (uint64_t)(((grid_wide)(time_ns - grid->epoch_ns) * grid->numerator + period - 1) / period);
	const grid_wide before = (grid_wide)(grid->epoch_ns - time_ns) * grid->numerator / period;
	return before < grid->epoch_vblank ? grid->epoch_vblank - (uint64_t)before : 0;
}

static inline double grid_period_ns(const struct grid *grid)
{
	return 1e9 * (double)grid->denominator / (double)grid->numerator;
}

#endif
