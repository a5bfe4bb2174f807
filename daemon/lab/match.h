/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Which edge of an input belongs to which flip. An edge at time e belongs to the
 * newest flip with
 *     flip + least <= e < flip + most
 * that an edge of this direction is expected of; if that flip has one already,
 * or there is no such flip, the edge is stray. A flip that expects an edge and
 * gets none is lost. So a lost, doubled or late edge costs its own flip and no
 * other. Sound as long as most - least is no longer than the shortest time
 * between two flips that expect the same direction: one refresh for pulses, two
 * for a patch that alternates.
 *
 * Edges within `debounce` after one that was accepted are contact bounce and
 * are ignored; the first edge counts, so its time is not falsified.
 *
 * Results come in the order of flips, once nothing can change them any more.
 * Pure: times are passed in. One thread.
 */
#ifndef PURSUIT_LAB_MATCH_H
#define PURSUIT_LAB_MATCH_H

#include <stdbool.h>
#include <stdint.h>

#define MATCH_FLIPS 512u /* of the longest window */
#define MATCH_EDGES 512u

enum match_want {
	MATCH_NONE = 0, /* the light does not change at this flip */
	MATCH_RISING,
	MATCH_FALLING,
	MATCH_EITHER,
};

enum match_fate {
	MATCH_HIT,    /* flip and edge */
	MATCH_LOST,   /* a flip that an edge was expected of */
	MATCH_SILENT, /* a flip that none was expected of */
	MATCH_STRAY,  /* an edge without a flip */
};

struct match_result {
	enum match_fate fate;
	uint64_t number;  /* of the flip */
	uint64_t edge_ns; /* of the edge, 0 none */
};

/* Zeroed apart from the first three is ready. */
struct match {
	uint64_t least_ns, most_ns, debounce_ns;
	struct match_flip {
		uint64_t number, flip_ns, edge_ns;
		enum match_want want;
	} flips[MATCH_FLIPS];
	struct match_edge {
		uint64_t time_ns;
		bool rising;
	} edges[MATCH_EDGES];
	uint32_t flip_count, edge_count;
	uint64_t accepted_ns; /* the last edge that was no bounce */
	uint64_t hits, lost, stray, bounced, overflowed;
};

/* In the order of time. */
void match_add_flip(struct match *match, uint64_t number, uint64_t flip_ns, enum match_want want);
void match_add_edge(struct match *match, uint64_t time_ns, bool rising);

/*
 * The next thing that is settled, false if there is none. Edges and flips older
 * than now - `hold` have all been added: that is how late events may come.
 */
bool match_next(struct match *match, uint64_t now_ns, uint64_t hold_ns, struct match_result *result);

#endif
