/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The display delay: one constant, learned from the ages at which real frames
 * were shown first (vblank - moment depicted). Pure arithmetic. One thread.
 *
 * Where T is p / q vblanks exactly, ages lie at q places, and the delay is one
 * of them, so that real frames have phase 0. It stays there while some frames
 * still come at that age, and moves when three quarters of the last 0.4 s, or
 * all of the last 0.2 s, came more than half a vblank away from it.
 *
 * Elsewhere ages sweep through one vblank from the least age at which frames
 * are ready, and following them would be a slow beat in what is shown. The
 * delay is the middle of the sweep; once there it stays while it is within a
 * quarter of a vblank of that.
 *
 * It moves by 60 ms a second (motion 6% faster for a third of a second at
 * most), 2 ms a second for what is less than a tenth of a vblank, and at once
 * beyond two vblanks: then it is another scene or time base. A display that goes
 * over to another mode begins it anew: ages on the old vblanks say nothing.
 */
#ifndef PURSUIT_DELAY_H
#define PURSUIT_DELAY_H

#include <stdbool.h>
#include <stdint.h>

#define DELAY_HISTORY 32u

struct delay_sample {
	int64_t age_ns;   /* when shown */
	int64_t ready_ns; /* when the picture could have been shown */
	uint64_t time_ns; /* of showing */
};

/* Zeroed: nothing known. */
struct delay {
	int64_t delay_ns;
	struct delay_sample samples[DELAY_HISTORY];
	uint32_t count;    /* since the time base was taken anew; the newest are kept */
	uint64_t moved_ns; /* when delay_ns was last moved */
	double vblank_ns;  /* of the samples */
	bool sweeps;       /* followed as a sweep */
	bool moving;       /* fast, until it is there */
};

/* A real frame was shown first. fraction: q of T = p / q vblanks, 0 where the rates slip. */
void delay_add(struct delay *delay, const struct delay_sample *sample, uint32_t fraction, double vblank_ns);

/* Takes the newest sample back: that showing did not come to pass. delay_ns stays. */
void delay_undo(struct delay *delay);

/*
 * The age at which the next frame can be shown, as the samples of the last 0.4 s explain it: frames that are ready
 * at an age are shown at the next vblank. Only with a sample.
 */
int64_t delay_reachable(const struct delay *delay, double vblank_ns);

#endif
