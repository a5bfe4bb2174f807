/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * An external vsync: a wire on which the display, or a sensor in front of it,
 * gives an edge at each vblank. For displays that stamp nothing themselves:
 * presenters that count vblanks by a clock follow its grid, and those that know
 * a flip only by the return of a call date it back to the vblank of this grid.
 *
 * Edges are fitted by vblanks.h and judged, for a wire can be anything:
 *
 *   bounce     less than an eighth of a period after an edge that counted:
 *              ignored, the first one counts
 *   extra      anywhere else where no vblank is expected: ignored, and bad
 *   missed     a vblank without an edge: bad
 *   rate       more than 2.5 % off the display's
 *   jitter     of more than 2 % of a period
 *   silence    no edge for eight vblanks
 *
 * It is trusted after 64 vblanks with at most 3 bad ones, of the right rate and
 * without jitter; no more after silence, at a wrong rate, or when more than 16
 * of the last 64 are bad. Then it is learned from anew.
 *
 * Times are passed in, never read. Locked: any thread.
 */
#ifndef PURSUIT_VSYNC_H
#define PURSUIT_VSYNC_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/present/grid.h"
#include "daemon/present/vblanks.h"

#define VSYNC_SENTENCE 160u

enum vsync_state {
	VSYNC_LEARNING = 0,
	VSYNC_TRUSTED,
	VSYNC_REFUSED, /* and learning */
};

struct vsync_counts {
	enum vsync_state state;
	uint64_t edges, bounced, extra, missed; /* ever */
	uint64_t trusted;                       /* times that it became so */
	double period_ns, jitter_ns;            /* as learned now */
};

struct vsync;

/* period_ns: the display's, as wished for. offset_ns: a vblank is so long after its edge. NULL: no memory. */
struct vsync *vsync_create(double period_ns, double offset_ns);
void vsync_destroy(struct vsync **vsync);

/* ---- whoever reads the wire ---- */

/* Another wire, or the other edge of it: learned from anew, trusted no more. */
void vsync_restart(struct vsync *vsync, double offset_ns);
/* An edge of the kind that counts, in the order of times. */
void vsync_add_edge(struct vsync *vsync, uint64_t time_ns);
/* To be called after edges and at vsync_next(): has it become trusted, or is it no more? Then the sentence says so. */
bool vsync_check(struct vsync *vsync, uint64_t now_ns, char sentence[VSYNC_SENTENCE]);
/* When silence has lasted too long; UINT64_MAX: never. */
uint64_t vsync_next(struct vsync *vsync);
struct vsync_counts vsync_get_counts(struct vsync *vsync);

/* ---- presenters; NULL accepted: there is none ---- */

/* The display's period is this. Another one than before begins anew. */
void vsync_expect(struct vsync *vsync, double period_ns);
/*
 * Its vblanks, numbered by themselves. 0: it is not to be trusted now; else the number of the trust: as long as that
 * stays, numbers of vblanks go on.
 */
uint64_t vsync_get_grid(struct vsync *vsync, uint64_t now_ns, struct grid *grid);
/*
 * The call that shows a picture came back at *time_ns: the flip was at the vblank before, to which *time_ns is moved;
 * *sequence becomes its count. display: what the returns alone say; one of another rate belongs to another display.
 * False: nothing is known, nothing was changed.
 */
bool vsync_date_back(struct vsync *vsync, const struct vblanks *display, uint64_t *time_ns, uint64_t *sequence);

#endif
