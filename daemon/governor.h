/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The quality governor: leaves more and more out, in a fixed order, when the
 * work for a real frame and its in-betweens no longer fits into the vblanks that
 * they fill, and takes it back. Pure arithmetic; time is passed in. One thread.
 *
 *   level  name    what is left out, on top of the levels before
 *   0      full    nothing: as configured
 *   1      coarse  cells of twice the size
 *   2      plain   blur and boost
 *   3      fewer   every second in-between: the picture before stays for it
 *   4      hold    all in-betweens: each real frame stays; nothing is analysed
 *
 * Up a level when the load (work / time there was for it, mean of about eight
 * frames) is above 0.9, or above 0.5 when three in-betweens of the last sixteen
 * frames were late; eight frames at least from level to level. Down a level when
 * the load is below 0.65 or has been bearable for a while, nothing is late, and
 * the last change is a second old. A level that had to be left again within two
 * seconds is tried only after twice the time, up to 32 s.
 *
 * Real frames are never left out. Replay does not govern: --level fixes it.
 */
#ifndef PURSUIT_GOVERNOR_H
#define PURSUIT_GOVERNOR_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/engine/engine.h"

#define GOVERNOR_LEVELS 5u

struct governor {
	bool automatic;
	uint32_t least; /* level that is configured: never below */
	uint32_t level;
	double load;       /* mean share of the time that work takes */
	uint32_t frames;   /* since the last change of level */
	uint32_t late[16]; /* in-betweens of the last frames */
	uint64_t changed_ns, lowered_ns, patience_ns;
	bool trying;              /* the level was lowered and has not stood the test yet */
	uint64_t raised, lowered; /* ever */
	uint64_t frames_at[GOVERNOR_LEVELS];
};

/* What one real frame and its in-betweens took. */
struct governor_sample {
	uint64_t now_ns;
	uint64_t work_ns; /* drawing, and what late in-betweens would have taken */
	uint64_t time_ns; /* of the vblanks that it filled */
	uint32_t late_in_betweens;
};

/* level: where it begins and below which it never goes, 0 to GOVERNOR_LEVELS - 1. */
void governor_init(struct governor *governor, bool automatic, uint32_t level);

/* Other settings from now on, as in governor_init(); what was counted stays. */
void governor_configure(struct governor *governor, bool automatic, uint32_t level, uint64_t now_ns);

/* A real frame and its in-betweens are over. The level of the next. */
uint32_t governor_add(struct governor *governor, const struct governor_sample *sample);

/* "full", "coarse", "plain", "fewer", "hold". Static. */
const char *governor_level_name(uint32_t level);

/* The engine's settings at a level, from those configured. */
void governor_apply(uint32_t level, struct engine_params *params);

/* Is the in-between at the k-th vblank after the real frame's (1, 2, ...) drawn at this level? */
bool governor_draws(uint32_t level, uint64_t k);

#endif
