/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Statistics of one output: counters, percentiles, what ran, and the timeline
 * of the last displayed frames. Knows no GL, no socket and no clock. One
 * thread; others read what it has published.
 */
#ifndef PURSUIT_STATS_H
#define PURSUIT_STATS_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "daemon/engine/engine.h"
#include "daemon/governor.h"
#include "daemon/lab/histogram.h"
#include "daemon/present/presenter.h"

enum stats_show {
	STATS_REAL = 0,
	STATS_IN_BETWEEN,
	STATS_REPEAT,  /* the same picture again, as intended: nothing moves, or no newer frame of a fast stream */
	STATS_STANDBY, /* plain picture for an in-between that was late */
	STATS_KEPT,    /* nothing was there in time: the picture stayed */
};
const char *stats_show_name(enum stats_show show);

/* One vblank. Times in ns, 0 unknown. */
struct stats_row {
	uint64_t vblank, target_ns, ready_ns, flip_ns, frame_id;
	uint32_t show; /* enum stats_show */
	float phase;
};

#define STATS_TIMELINE 4096u
#define STATS_NAMES 24u

struct stats_name {
	const char *name; /* static */
	uint64_t count;
};

struct stats {
	uint64_t real_frames;       /* shown */
	uint64_t in_between_frames; /* shown */
	uint64_t repeated_frames;   /* vblanks that showed the same again, as intended */
	uint64_t standby_frames;    /* vblanks that showed the plain picture instead of a late in-between */
	uint64_t displayed_frames;  /* all of these four */
	uint64_t late_in_betweens;  /* vblanks whose in-between was not ready */
	uint64_t late_real_frames;  /* real frames shown at least a vblank later than aimed at */
	uint64_t lost_real_frames;  /* real frames that never were shown */
	uint64_t received_frames;   /* taken from the streams and valid */
	uint64_t refused_frames;
	uint64_t vblanks_due;     /* vblanks at which a picture was due: all but pauses */
	uint64_t vblanks_on_time; /* of these, with the intended picture, ready before and shown before the next */
	uint64_t late_flips;      /* the presenter itself was late by a vblank or more */
	double vblank_ns;         /* the display's period as it is known now; 0 unknown */
	uint64_t active_ns;       /* time over all vblanks due */
	uint64_t engine_losses;
	uint64_t unbalanced_vblanks; /* late in-betweens of boosted real frames: light that was missed, not carried */
	uint64_t flips_by_source[PRESENTER_TIME_SOURCES]; /* where their time stamps are from */
	struct governor governor;                         /* as it is now */
	uint64_t
		engine_bytes; /* that the engine takes, in GL's memory and its own, as of the last real frame; 0: not counted */
	struct stats_name passes[STATS_NAMES], left_out[STATS_NAMES];
	uint32_t pass_count, left_out_count;
	uint64_t timeline_count; /* ever; the newest are kept */
	/* last: see stats_publish() */
	struct stats_spans {
		struct histogram engine, submit_to_flip, flip_error; /* ns */
		struct histogram overhead; /* from a real frame's submission to its picture, less the engine's work meanwhile */
	} spans;
	uint64_t spans_count; /* of a copy: rows when the spans were copied */
	struct stats_row timeline[STATS_TIMELINE];
};

/* The engine's report about one real frame. */
void stats_add_report(struct stats *stats, const struct engine_report *report);
void stats_add_row(struct stats *stats, const struct stats_row *row);

/* Of a histogram, in ms: what JSON and the view say. */
double stats_percentile_ms(const struct histogram *histogram, double share);

/*
 * Brings a copy up to date: the figures, and the rows that it lacks. Microseconds. The spans are large, so after the
 * first rows they are copied once in eight.
 */
void stats_publish(const struct stats *stats, struct stats *copy);

/* A JSON object with the figures by their names; the caller owns it. NULL: out of memory. */
json_t *stats_json(const struct stats *stats);
/* {"first", "rows": [[vblank, target, ready, flip, frame_id, show, phase], ...]}: at most count rows from row `from`.
 */
json_t *stats_timeline_json(const struct stats *stats, uint64_t from, uint64_t count);

#endif
