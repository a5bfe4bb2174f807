/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The pacer: which picture belongs to which vblank. Pure arithmetic; time is
 * passed in, never read; knows no GL, no socket and no clock. One thread.
 *
 * Vblanks lie on a grid (grid.h) that may change while their numbers go on, as
 * a display's true period and phase are learned (vblanks.h).
 *
 * phase = (target vblank - real frame's time - display delay) / T, with T of
 * interval.h and the display delay of delay.h, which ratio.h tells how the two
 * rates go together: constants for a steady client,
 * so that it gets steady phases.
 *
 * N is predicted: the next real frame's time is this one's + T, and it is
 * expected at the first vblank that frames of that age could reach so far. So
 * N alternates as it must where the rates have no whole ratio (45 on 120 Hz:
 * 3, 3, 2). A stream at least as fast as the display passes through: no
 * extrapolation, phase 0, N = 1.
 */
#ifndef PURSUIT_PACER_H
#define PURSUIT_PACER_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/present/delay.h"
#include "daemon/present/grid.h"
#include "daemon/present/interval.h"
#include "daemon/present/ratio.h"

/* A real frame's first showing is plain up to this |phase|. */
#define PACER_PLAIN_PHASE 0.05

struct pacer_params {
	struct grid grid; /* 1 to 1000 Hz; zeroed: 120 Hz, vblank 0 at 0 */
	bool fixed_delay; /* replay: the display delay is delay_ns and is not learned */
	int64_t delay_ns;
	double max_phase; /* beyond it nothing is extrapolated; 0: 2 */
};

/* The real frame that the pacer was told of last. */
struct pacer_frame {
	uint64_t frame_id;
	uint64_t time_ns;     /* the moment that it depicts */
	uint64_t interval_ns; /* as the client declares, 0 unknown */
	uint64_t intake_ns;   /* when the daemon saw it */
	uint64_t ready_ns;    /* when its first picture is expected to be done; 0: as intake_ns */
};

enum pacer_show {
	PACER_NOTHING = 0, /* no real frame yet */
	PACER_REAL,        /* first showing of the newest real frame */
	PACER_IN_BETWEEN,  /* extrapolated to `phase` */
	PACER_REPEAT, /* the same picture as the vblank before: the stream pauses, or display at most as fast as stream */
};

struct pacer_decision {
	enum pacer_show show;
	uint64_t frame_id;
	uint64_t target_ns;
	double phase;         /* of target_ns; for PACER_REAL 0 if |phase| <= PACER_PLAIN_PHASE */
	uint32_t n;           /* vblanks that this real frame is expected to fill, 1 to 8 */
	double last_phase;    /* of its last expected in-between */
	uint64_t interval_ns; /* T as the pacer knows it; 0 unknown */
};

struct pacer {
	struct pacer_params params;
	struct pacer_frame frame; /* newest */
	bool has_frame, frame_is_new, passes_through;
	uint64_t interval_ns; /* T; 0 unknown */
	int64_t delay_ns;     /* display delay */
	struct interval interval;
	struct ratio ratio;
	struct delay delay;
	uint64_t first_vblank; /* of the newest real frame's first showing */
	uint32_t n;            /* of the newest real frame, once shown */
	double last_phase;
};

void pacer_init(struct pacer *pacer, const struct pacer_params *params);

/* What is known of the display's vblanks now; their numbers go on. Ignored if it has no rate. */
void pacer_set_grid(struct pacer *pacer, const struct grid *grid);

/* Time of vblank k, and the first vblank at or after a time. Exact for 2^63 ns. */
uint64_t pacer_vblank_time(const struct pacer *pacer, uint64_t vblank);
uint64_t pacer_vblank_at_or_after(const struct pacer *pacer, uint64_t time_ns);

/*
 * A newer real frame has arrived; it replaces an older one that was not shown yet (newest wins).
 * A time_ns of 0 stands for intake_ns.
 */
void pacer_add_frame(struct pacer *pacer, const struct pacer_frame *frame);

/*
 * What vblank `vblank` shows. Call once per vblank, in rising order; vblanks
 * may be skipped (they were missed), and vblanks that were decided but are not
 * over may be decided again after pacer_add_frame(). Changes only the pacer.
 */
struct pacer_decision pacer_decide(struct pacer *pacer, uint64_t vblank);

/*
 * The vblank at which the next real frame is expected to be shown first, if it
 * keeps its interval; 0: unknown.
 */
uint64_t pacer_next_real_vblank(const struct pacer *pacer);

/* The stream is about as fast as the display, or faster: nothing is extrapolated. */
bool pacer_passes_through(const struct pacer *pacer);

/*
 * The decision could not be kept (the picture came too late): what was to be shown was not. A real frame is
 * then decided again for a later vblank.
 */
void pacer_missed(struct pacer *pacer, const struct pacer_decision *decision);

#endif
