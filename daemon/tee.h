/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Records what is shown, whatever presents it: each displayed frame once a
 * vblank into a YUV4MPEG2 file, or into a PNG image each, numbered from 0, and
 * beside them, one row a frame, which vblank it was and when, and its number. A thread writes;
 * where it does not keep up, or the disk is full, frames are dropped and counted,
 * presentation never waits.
 */
#ifndef PURSUIT_TEE_H
#define PURSUIT_TEE_H

#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/present/grid.h"
#include "daemon/present/presenter.h"

struct tee;

/* For the times, with the end. */
#define TEE_TIMES_BYTES 528u

struct tee_params {
	const char *path; /* of the video; with a % a pattern like "out/%06d.png" */
	const struct log *log;
	uint64_t patience_ns; /* with a disk that takes nothing at all; 0: five seconds */
};

/* Where the times go: PATH.csv, or out/times.csv. */
void tee_times_path(const char *path, char times[TEE_TIMES_BYTES]);

/*
 * Opens both files. Images get numbers after those that are there; what else is there is written over
 * (owners_keep_files() puts it aside). NULL with a sentence.
 */
struct tee *tee_create(const struct tee_params *params, struct error *error);
/*
 * Writes what is waiting, closes, says in the log what was written and what was not. A disk is given up that takes no
 * picture for as long as the patience, or has not taken all after six times that; should it answer later, what was
 * waiting is written and closed all the same, unless the process has ended. NULL accepted.
 */
void tee_destroy(struct tee **tee);

/* The next two on one thread, that which draws: one copy of the picture. */

/* A picture that was given to the presenter and may be shown. */
void tee_add(struct tee *tee, const struct presenter_image *image, uint64_t group, uint64_t serial);
/* A vblank of this grid is over. The video's rate is that of the display at the first one. */
void tee_flip(struct tee *tee, const struct presenter_flip *flip, const struct grid *grid);

#endif
