/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What the marker lines do at each flip, as arithmetic: flips in, changes of
 * levels out. Levels are logical (the chip turns them round for active-low
 * lines), bit i is line i of the list. Pure; one thread.
 */
#ifndef PURSUIT_LAB_PATTERN_H
#define PURSUIT_LAB_PATTERN_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/lab/points.h"

#define PATTERN_LINES 16u

enum pattern_kind {
	PATTERN_TOGGLE = 0,  /* changes at each flip */
	PATTERN_PULSE,       /* a pulse at each flip */
	PATTERN_PULSE_REAL,  /* a pulse at the first showing of each real frame */
	PATTERN_LEVEL_REAL,  /* high from a real frame's first showing until an in-between is shown */
	PATTERN_THREE_LINES, /* pulses: each flip, real frames, in-between frames */
	PATTERN_COUNTER,     /* the vblank's number in binary, line 0 lowest */
	PATTERN_SEQUENCE,    /* the level of the photodiode patch on display */
	PATTERN_KINDS,
};

/* One flip. */
struct pattern_flip {
	uint64_t vblank;
	uint64_t flip_ns;
	uint8_t show; /* enum points_show */
	bool level;   /* of the photodiode patch on display */
};

/* Lines of the mask get these levels at time_ns; if pulse_ns is not 0 they go back low so long after they were set. */
struct pattern_change {
	uint64_t time_ns;
	uint64_t vblank; /* that it marks */
	uint32_t mask, levels;
	uint64_t pulse_ns;
};

struct pattern {
	enum pattern_kind kind;
	uint32_t lines; /* 1 to PATTERN_LINES */
	uint64_t pulse_ns;
	uint64_t offset_ns; /* after the flip */
	uint32_t levels;    /* that stay, as planned; starts with the initial ones */
};

/* Lines that a pattern wants: exactly `lines`, or 1 to PATTERN_LINES if 0 (the counter). */
uint32_t pattern_lines(enum pattern_kind kind);

/* Does this flip change anything? Then *change says what. */
bool pattern_add_flip(struct pattern *pattern, const struct pattern_flip *flip, struct pattern_change *change);

/* ---- changes that wait for their time ---- */

#define SCHEDULE_CHANGES 64u

/* Zeroed is empty. */
struct schedule {
	struct pattern_change changes[SCHEDULE_CHANGES]; /* in the order of times */
	uint32_t count;
	uint64_t dropped; /* by schedule_add() on a full one */
};

/* False: there is no room, it is dropped. */
bool schedule_add(struct schedule *schedule, const struct pattern_change *change);
/* The same for what pattern_add_flip() has just given: if it is dropped the pattern goes on from the levels before it.
 */
bool pattern_schedule(struct pattern *pattern, struct schedule *schedule, const struct pattern_change *change);
/* When the next one is due; UINT64_MAX for none. */
uint64_t schedule_next(const struct schedule *schedule);
/* Takes the first that is due; changes that are late come one by one, so that no edge is lost. False: none is due. */
bool schedule_take(struct schedule *schedule, uint64_t now_ns, struct pattern_change *change);

#endif
