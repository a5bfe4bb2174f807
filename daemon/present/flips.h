/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What a presenter without a display controller needs: which picture is queued
 * for which vblank, which one is on display, which one stands by. Pure; pictures
 * are numbers from 0 to FLIPS_IMAGES - 1; times and locks are the caller's.
 */
#ifndef PURSUIT_FLIPS_H
#define PURSUIT_FLIPS_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/present/presenter.h"

#define FLIPS_IMAGES 12u
#define FLIPS_QUEUED 6u
#define FLIPS_STANDBYS 2u

struct flips_picture {
	uint64_t vblank; /* while queued */
	uint64_t serial;
	uint64_t group;
	uint32_t image;
};

/* Zeroed: nothing queued, nothing shown. */
struct flips {
	struct flips_picture queue[FLIPS_QUEUED]; /* in the order of vblanks */
	uint32_t queued;
	struct flips_picture standby[FLIPS_STANDBYS]; /* the newest last */
	uint32_t standbys;
	struct flips_picture front;
	bool has_front;
	bool dropped;                     /* as in struct presenter_flip, of the vblank shown last */
	uint8_t references[FLIPS_IMAGES]; /* acquired, queued, standing by, on display */
};

/* A picture that nobody uses, now acquired; -1: none. */
int flips_acquire(struct flips *flips);
void flips_release(struct flips *flips, uint32_t image);

/* Takes over the caller's reference. False: the queue is full of earlier vblanks. */
bool flips_present(struct flips *flips, uint32_t image, uint64_t vblank, uint64_t group, uint64_t serial);

/* Takes over the caller's reference. */
void flips_set_standby(struct flips *flips, uint32_t image, uint64_t group, uint64_t serial);
void flips_clear_standby(struct flips *flips);

/*
 * Vblank `vblank` is here: changes the front and says what is shown. Entries for earlier vblanks, which were skipped,
 * are dropped, but for the first one of a group that is not on display yet: a real frame is late, never lost.
 */
enum presenter_shown flips_show(struct flips *flips, uint64_t vblank);

#endif
