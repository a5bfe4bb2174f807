/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What was to be shown at each vblank and what was: turns the presenter's flip
 * events into statistics, the timeline and feedback to the client. Belongs to
 * the render thread, and so do the statistics.
 */
#ifndef PURSUIT_SHOWING_H
#define PURSUIT_SHOWING_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/intake.h"
#include "daemon/present/presenter.h"
#include "daemon/stats.h"

/* Powers of two, more than are ever under way. */
#define SHOWING_PICTURES 64u
#define SHOWING_VBLANKS 64u
#define SHOWING_FRAMES 8u

/* A picture given to the presenter. */
struct showing_picture {
	uint64_t serial;
	uint64_t group;
	uint64_t ready_ns;
	enum stats_show show; /* REAL, IN_BETWEEN, STANDBY; REPEAT for the plain picture at the start of a pause */
	float phase;
};

enum showing_plan {
	SHOWING_UNDECIDED = 0, /* nobody decided in time */
	SHOWING_REAL,
	SHOWING_IN_BETWEEN,
	SHOWING_REPEAT, /* the same picture again is right */
	SHOWING_PAUSE,  /* the stream pauses: nothing is due */
};

/* One real frame. */
struct showing_frame {
	uint64_t group;        /* 0: free */
	struct stream *stream; /* referenced; NULL: it has ended */
	struct pursuit_feedback report;
	bool boosted; /* its first showing gives light that its in-betweens take away */
	bool queued;  /* the presenter has its picture, so it will be shown, unless a newer one comes first */
};

struct showing {
	struct stats *stats;
	struct showing_picture pictures[SHOWING_PICTURES];
	struct {
		uint64_t vblank;
		enum showing_plan plan;
	} plans[SHOWING_VBLANKS];
	struct showing_frame frames[SHOWING_FRAMES];
	uint64_t front_group;
	uint64_t settling;       /* the group that showing_settle_frames() was called with last */
	uint64_t last_target_ns; /* of the vblank before, if one was due then; otherwise 0 */
	uint64_t next_submit_ns; /* hint that goes into reports */
	bool pausing;            /* an undecided vblank is no miss */
	double period_ns;        /* between vblanks, as known now */
};

void showing_init(struct showing *showing, struct stats *stats);
void showing_finish(struct showing *showing);

/* Gives streams that have ended back at once: their clients are gone, nobody reads a report. */
void showing_forget_ended(struct showing *showing);

/* A real frame was taken and will be shown as this group. Keeps a reference to the stream. */
void showing_add_frame(struct showing *showing, uint64_t group, struct stream *stream, const struct frame *frame);
struct showing_frame *showing_find_frame(struct showing *showing, uint64_t group);

void showing_add_picture(struct showing *showing, const struct showing_picture *picture);
/* One that was not ready when it was added; before its flip is told. */
void showing_set_ready(struct showing *showing, uint64_t serial, uint64_t ready_ns);
void showing_plan(struct showing *showing, uint64_t vblank, enum showing_plan plan);

/* A vblank is over. */
void showing_flip(struct showing *showing, const struct presenter_flip *flip);

/* Is there a real frame that was taken, not refused, and not shown yet? */
bool showing_has_unshown(const struct showing *showing);
/* One of which the presenter has the picture? */
bool showing_awaits(const struct showing *showing);

/* Reports every frame of groups before `group`: shown, or replaced if it never was. */
void showing_close_frames(struct showing *showing, uint64_t group);
/*
 * The same, but one that the presenter has is waited for, and those after it, so that reports come in order: to be
 * called again, with `settling`, after each flip.
 */
void showing_settle_frames(struct showing *showing, uint64_t group);

#endif
