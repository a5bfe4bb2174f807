/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Recordings of what is shown that follow each other while it goes on: each has
 * the pictures that were drawn while it was the newest, shown whenever they are.
 * One that another has followed is closed when the real frame is over that it had
 * its last picture of. On the thread that draws.
 */
#ifndef PURSUIT_TEES_H
#define PURSUIT_TEES_H

#include "daemon/tee.h"

/* That may follow each other within a real frame; with more the oldest is closed, and its last pictures may be missing.
 */
#define TEES_BEFORE 16u

/* Zeroed but for `close`, `data` and `log`: none. */
struct tees {
	void (*close)(void *data, struct tee *tee); /* takes it; nobody waits */
	void *data;
	const struct log *log;
	struct tee *now; /* NULL: none */
	uint64_t since;  /* serial of the last picture that was drawn before it came */
	struct tees_before {
		struct tee *tee;
		uint64_t since, last; /* serials: its pictures are those after the first, up to the second */
		uint64_t group;       /* of the last */
	} before[TEES_BEFORE];    /* in their order */
	uint32_t count;
	uint64_t awaited; /* those with no picture after this one are closed when it has been shown; 0: none */
};

/* This one (NULL: none) has what is drawn after picture `serial`, which is of `group`. */
void tees_follow(struct tees *tees, struct tee *tee, uint64_t group, uint64_t serial);
/* As tee_flip(), of the one whose picture it is. */
void tees_flip(struct tees *tees, const struct presenter_flip *flip, const struct grid *grid);
/*
 * Of all that was drawn nothing is still to be shown once this picture has been (0: nothing at all): then those before
 * are closed whose pictures were drawn up to it.
 */
void tees_rest(struct tees *tees, uint64_t awaited);
/* Waits for all of them. */
void tees_finish(struct tees *tees);

#endif
