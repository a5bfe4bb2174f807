/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Which picture a display controller shows, which one is on its way to it, and
 * what each vblank is reported to have shown. A controller takes one flip at a
 * time, ahead of the vblank, and says afterwards at which vblank it happened; so
 * a picture has three owners in turn: the queue (struct flips), the flip under
 * way, the display. It can be drawn into again only when none of them holds it.
 *
 * A picture that its vblank did not get, because a flip was still under way or
 * was refused, is shown at the next vblank that has none of its own: late, never lost.
 *
 * Pure; flips and locks are the caller's.
 */
#ifndef PURSUIT_SCANOUT_H
#define PURSUIT_SCANOUT_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/present/flips.h"

struct scanout_picture {
	bool any;
	uint32_t image;
	uint64_t serial, group;
};

/* Zeroed: nothing queued, nothing shown, vblank 0 is the first that is reported. */
struct scanout {
	struct flips flips;
	enum presenter_shown chosen_as; /* how flips.front came to be the front */
	uint64_t chosen_vblank;         /* and for which vblank */
	struct scanout_picture under_way, shown;
	uint64_t under_way_vblank; /* the vblank it is to happen at */
	uint64_t under_way_wanted; /* the vblank that its picture was chosen for: before it if a flip was refused or busy */
	enum presenter_shown under_way_as;
	bool fresh, fresh_late; /* `shown` was not reported yet */
	uint64_t fresh_wanted;  /* as under_way_wanted */
	enum presenter_shown fresh_as;
	struct presenter_flip waiting; /* a vblank whose flip has not been heard of */
	bool is_waiting;
	bool dropped;         /* as in struct presenter_flip, for the next report */
	uint64_t next_vblank; /* the first that is to be reported */
	uint64_t told;        /* reports so far were of vblanks below this one */
	bool paused;
};

/* Reports begin at this vblank; one that is still waited for is given up. */
void scanout_start(struct scanout *scanout, uint64_t vblank);

/* Until scanout_start() no vblank is reported but one at which a picture comes on display that was under way. */
void scanout_pause(struct scanout *scanout);

/*
 * The picture for a vblank that is close: flip to this image now. It counts as under way until scanout_flipped() or
 * scanout_failed(). -1: nothing to do, the picture stays or a flip is under way. May be called again for the same
 * vblank while nothing is under way.
 */
int scanout_choose(struct scanout *scanout, uint64_t vblank);

/* The controller did not take the flip; the picture is tried again for the next vblank. */
void scanout_failed(struct scanout *scanout);

/* Both give the reports that are due now: at most 2, in the order of vblanks. */

/* The flip under way happened at a vblank. Of `flip` vblank, target_ns, flip_ns, sequence, time_source are taken over.
 */
uint32_t scanout_flipped(struct scanout *scanout, const struct presenter_flip *flip, struct presenter_flip reports[2]);

/* A vblank came; `flip` likewise. */
uint32_t scanout_vblank(struct scanout *scanout, const struct presenter_flip *flip, struct presenter_flip reports[2]);

#endif
