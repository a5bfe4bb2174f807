/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * T, the interval between a client's real frames. Pure arithmetic; time is
 * passed in, never read. One thread.
 *
 * T is the mean of the intervals of the last half second that lie within half
 * of their median: noise averages out, stalls and bursts do not count. When
 * four of the newest five speak for another rate T is begun anew from these.
 */
#ifndef PURSUIT_INTERVAL_H
#define PURSUIT_INTERVAL_H

#include <stdbool.h>
#include <stdint.h>

#define INTERVAL_HISTORY 32u

/* Zeroed: nothing known. */
struct interval {
	uint64_t interval_ns; /* T; 0 unknown */
	uint64_t history[INTERVAL_HISTORY];
	uint32_t count; /* since the rate was last taken anew; the newest are kept */
	uint64_t last_id, last_ns;
	bool stepped; /* the newest frame began it anew */
};

/*
 * A real frame that depicts time_ns. declared_ns: since the frame that the client submitted before, 0 unknown; where
 * that frame was not taken the difference of times counts. Intervals below half a ms or above a second teach nothing.
 */
void interval_add(struct interval *interval, uint64_t frame_id, uint64_t time_ns, uint64_t declared_ns);

#endif
