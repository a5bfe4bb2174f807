/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * How a client's rate goes with the display's: do frames come at the same few
 * places of a vblank for ever, or do they slip? 59.94 frames on 120 Hz slip by a
 * vblank every eight seconds, 60 do not. Pure arithmetic; time is passed in,
 * never read. One thread.
 *
 * The rate is the slope of a straight line through the times of the newest
 * frames, as many as lie on one (6 to 32), and where these agree with what the
 * last 256 say (vblanks.h) of those. Each slope comes with its doubt, three
 * standard deviations, and so does the display's period; nothing is decided
 * before the doubts are small enough. A steady client is known after eight
 * frames, one with half a ms of noise after a hundred.
 */
#ifndef PURSUIT_RATIO_H
#define PURSUIT_RATIO_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/present/grid.h"
#include "daemon/present/vblanks.h"

#define RATIO_HISTORY 32u

struct ratio_frame {
	uint64_t id, time_ns;
};

/* Zeroed: nothing known. */
struct ratio {
	struct ratio_frame frames[RATIO_HISTORY];
	uint32_t count;       /* since the rate was last taken anew; the newest are kept */
	struct vblanks ticks; /* of the client */
	double vblank_ns;     /* the display's, when last compared */
	uint32_t fraction;    /* q of T = p / q vblanks where that holds exactly for a p and a q up to 5; 0: for none */
	uint32_t found, found_count; /* what would be in its place, and so many frames in a row */
};

/* The rate is another from this frame on, about one in interval_ns. Before anything is sure the fraction is 1. */
void ratio_restart(struct ratio *ratio, uint64_t frame_id, uint64_t time_ns, uint64_t interval_ns);

/* A real frame that depicts time_ns. */
void ratio_add(struct ratio *ratio, uint64_t frame_id, uint64_t time_ns);

/* Once a frame: compares with the display's grid and settles `fraction`. */
void ratio_compare(struct ratio *ratio, const struct grid *display);

#endif
