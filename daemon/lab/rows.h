/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Displayed frames whose time points are not all known yet: the flip comes
 * first, the edge follows, the render thread tells the rest, the light may come
 * refreshes later. Rows leave in the order of flips, once they are complete or
 * a second old; what is not known by then stays unknown. Pure; one thread.
 */
#ifndef PURSUIT_LAB_ROWS_H
#define PURSUIT_LAB_ROWS_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/lab/points.h"

/* As many as come while the oldest waits, at 500 Hz. */
#define ROWS 512u
/* Longer than the longest window for light, by the photon options' limits and what its edge may be late. */
#define ROWS_WAIT_NS UINT64_C(1000000000)

struct row {
	struct points points;
	bool told;        /* the render thread's part is in */
	bool edge_open;   /* an edge is on its way */
	bool photon_open; /* the photodiode may still see it */
};

/* Zeroed is empty. */
struct rows {
	struct row rows[ROWS];
	uint64_t first, end;    /* rows[i % ROWS] for first <= i < end */
	uint64_t taken_flip_ns; /* of the row taken last */
	uint64_t hold_ns;       /* complete rows wait so long after their event for edges that are older; set by the user */
};

/* A new row, of a flip; the oldest one must have been taken if ROWS are open. */
struct row *rows_add(struct rows *rows);
bool rows_full(const struct rows *rows);
/* The newest open row of this vblank, NULL none. */
struct row *rows_find(struct rows *rows, uint64_t vblank);
/* The render thread's part: frame, picture, their time points. */
void rows_tell(struct rows *rows, const struct points *points);
/*
 * An edge of the trigger input goes with the first flip that is not before it; of several the newest stays. False: that
 * flip is still to come. An edge whose flip's row was taken already is nobody's: it is not the next flip's.
 */
bool rows_trigger(struct rows *rows, uint64_t time_ns);
/* Takes the oldest row if it is complete, too old, or `force`d. What is still open becomes unknown, and is noted as
 * lost. */
bool rows_take(struct rows *rows, uint64_t now_ns, bool force, struct points *points);
/* When the oldest has waited long enough; UINT64_MAX for none. May be over. */
uint64_t rows_next(const struct rows *rows);

#endif
