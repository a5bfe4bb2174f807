/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The absolute grid of a display of fixed rate: vblank k is at
 *   epoch_ns + floor(k x 1e9 x denominator / numerator).
 * It does not drift: 8,333,333 ns and the rest, not 8 ms.
 */
#ifndef PURSUIT_GRID_H
#define PURSUIT_GRID_H

#include <stdint.h>

struct grid {
	uint64_t numerator; /* Hz = numerator / denominator */
	uint64_t denominator;
	uint64_t epoch_ns; /* of vblank 0 */
};

__extension__ typedef unsigned __int128 grid_wide;

static inline uint64_t grid_time(const struct grid *grid, uint64_t vblank)
{
	return grid->epoch_ns + (uint64_t)((grid_wide)vblank * UINT64_C(1000000000) * grid->denominator / grid->numerator);
}

/* The first vblank that is not before time_ns. For a whole d, floor(k x) >= d is k x >= d. */
static inline uint64_t grid_at_or_after(const struct grid *grid, uint64_t time_ns)
{
	const grid_wide period = (grid_wide)UINT64_C(1000000000) * grid->denominator;
	if (time_ns <= grid->epoch_ns)
		return 0;
	return (uint64_t)(((grid_wide)(time_ns - grid->epoch_ns) * grid->numerator + period - 1) / period);
}

static inline double grid_period_ns(const struct grid *grid)
{
	return 1e9 * (double)grid->denominator / (double)grid->numerator;
}

#endif
