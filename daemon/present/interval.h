/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * T, the interval between a client's real frames, and how it goes with the
 * display's. Pure arithmetic; time is passed in, never read. One thread.
 *
 * T is the mean of the intervals of the last half second that lie within half
 * of their median: noise averages out, stalls and bursts do not count. When
 * four of the newest five speak for another rate T is begun anew from these.
 *
 * A steady client ticks as a display does, and its rate to a millionth is
 * learned in the same way (vblanks.h): it tells 59.94 from 60 on 120 Hz, where
 * frames slip by a vblank every eight seconds, within one.
 */
#ifndef PURSUIT_INTERVAL_H
#define PURSUIT_INTERVAL_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/present/vblanks.h"

#define INTERVAL_HISTORY 32u

/* Zeroed: nothing known. */
struct interval {
	uint64_t interval_ns; /* T; 0 unknown */
	uint64_t history[INTERVAL_HISTORY];
	uint32_t count; /* since the rate was last taken anew; the newest are kept */
	uint64_t last_id, last_ns;
	struct vblanks ticks; /* of the client; from the first interval on */
	double period_ns;     /* the display's, when last compared */
	uint32_t fraction;    /* q of T = p / q vblanks where that holds exactly for a p and a q up to 5; 0: for none */
	uint32_t found, found_count; /* what would be in its place, and so many frames in a row */
};

/*
 * A real frame that depicts time_ns. declared_ns: since the frame that the client submitted before, 0 unknown; where
 * that frame was not taken the difference of times counts. Intervals below half a ms or above a second teach nothing.
 */
void interval_add(struct interval *interval, uint64_t frame_id, uint64_t time_ns, uint64_t declared_ns);

/* Once a frame: compares with the display's period and settles `fraction`. Before anything is sure it is 1. */
void interval_compare(struct interval *interval, double period_ns);

#endif
