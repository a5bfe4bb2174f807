/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A display's true period and phase, learned from the time stamps of its flips.
 * Pure arithmetic; time is passed in, never read. One thread.
 *
 * Give every stamp that there is, in the order of flips. The fit is a straight
 * line by least squares over about the last 256 stamps (an alpha-beta filter
 * with the gains 2 (2n - 1) / (n (n + 1)) and 6 / (n (n + 1)) of growing memory,
 * n up to 256). A stamp that lies far from the line (six times the usual
 * distance) moves nothing.
 *
 *   missed vblanks   with a sequence: as it counts. Without: a stamp belongs to
 *                    the vblank that it follows by at most 3/4 of a period, for
 *                    stamps are late rather than early.
 *   drift            the line follows within a few hundred vblanks.
 *   new period       eight stamps in a row off the line, or eight intervals
 *                    that agree on another period: the line is begun anew at
 *                    the newest stamp. A multiple of the period may as well be
 *                    stamps missed, and is believed after 16 without exception.
 *   long pauses      (64 vblanks) are counted by time, and the phase is taken
 *                    anew, for the period is not known to a millionth.
 *
 * Numbers never jump back; the grid's times of vblanks ahead move only by what
 * was learned.
 */
#ifndef PURSUIT_VBLANKS_H
#define PURSUIT_VBLANKS_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/present/grid.h"

#define VBLANKS_INTERVALS 16u

struct vblanks {
	struct grid wished; /* until the first stamp */
	uint64_t number;    /* of the newest stamp's vblank */
	uint64_t base_ns;   /* the line at `number`, whole ns and the rest */
	double rest_ns;
	double period_ns;
	double spread_ns;   /* mean distance of stamps from the line */
	double bias_ns;     /* mean signed distance of the last two dozen */
	uint32_t memory;    /* n of the gains */
	uint32_t strays;    /* stamps off the line, in a row */
	uint32_t backwards; /* stamps before the last one, in a row */
	bool started;
	uint64_t last_ns, last_sequence;
	double intervals[VBLANKS_INTERVALS];      /* between stamps, a vblank where a sequence says how many there were */
	uint32_t interval_count;                  /* since the period was last taken anew; the newest are kept */
	uint64_t stamps, outliers, missed, steps; /* ever: given, off the line, vblanks without a stamp, lines begun anew */
};

/* Hz = numerator / denominator as wished for or as the mode says; 0: 120. Vblank 0 is at now_ns. */
void vblanks_init(struct vblanks *vblanks, uint64_t numerator, uint64_t denominator, uint64_t now_ns);

/*
 * A flip at time_ns. sequence: the display's own count of vblanks, rising by one with each (32-bit counts may
 * wrap); 0: unknown. Returns the vblank's number on the grid. It is the same number as before where the stamp
 * before was late by more than 3/4 of a period, or this one lies before it.
 */
uint64_t vblanks_add(struct vblanks *vblanks, uint64_t sequence, uint64_t time_ns);

/* The grid as known now: {1e15, period in 1e-6 ns}, its epoch at the newest stamp's vblank, and the period's doubt. */
struct grid vblanks_get_grid(const struct vblanks *vblanks);

/* Period and phase rest on enough stamps to be called measured. */
bool vblanks_known(const struct vblanks *vblanks);

#endif
