/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * One displayed frame with all its time points: what ring, log and statistics
 * of the lab hold. CLOCK_MONOTONIC nanoseconds; each point is known, not yet
 * known, or unknown.
 */
#ifndef PURSUIT_LAB_POINTS_H
#define PURSUIT_LAB_POINTS_H

#include <stdbool.h>
#include <stdint.h>

enum point {
	POINT_SUBMIT = 0, /* the client published the real frame */
	POINT_INTAKE,     /* the daemon saw it */
	POINT_TARGET,     /* the vblank aimed at */
	POINT_READY,      /* the picture was done */
	POINT_FLIP,       /* shown, as the presenter says */
	POINT_EVENT,      /* the presenter's event reached the lab */
	POINT_EDGE,       /* the call that set the line for it came back */
	POINT_PHOTON,     /* the photodiode saw it */
	POINT_TRIGGER,    /* the newest edge of the trigger input, if one came since the flip before; by its stamp */
	POINT_COUNT,
};

#define POINT_UNKNOWN UINT64_C(0)
#define POINT_NOT_YET UINT64_MAX

static inline bool point_known(uint64_t time_ns)
{
	return time_ns != POINT_UNKNOWN && time_ns != POINT_NOT_YET;
}

enum points_show {
	POINTS_REAL = 0,
	POINTS_IN_BETWEEN,
	POINTS_REPEAT,  /* the same picture again, as intended */
	POINTS_STANDBY, /* plain picture for an in-between that was late */
	POINTS_KEPT,    /* nothing was there in time: the picture stayed */
	POINTS_SHOWS,
};

struct points {
	uint64_t vblank;
	uint64_t frame_id; /* of the real frame on display, 0 none */
	uint64_t time[POINT_COUNT];
	uint32_t set_ns;  /* how long the call that set the line took: the edge lies within so much before POINT_EDGE */
	uint32_t code;    /* index in the sequence, or parity's count, of the picture on display */
	uint32_t skipped; /* vblanks just before this one that nobody handled */
	float phase;
	uint8_t show;     /* enum points_show */
	uint8_t source;   /* enum presenter_time_source */
	bool late;        /* the flip was handled only after the next vblank's time */
	bool level;       /* of the photodiode patch on display */
	bool edge_lost;   /* the pattern wanted an edge; no line was there, or it was up still from the pulse before */
	bool photon_lost; /* light was expected to change, and no input saw it */
	char method[16];  /* that made the picture */
};

#define POINTS_BYTES 136u
_Static_assert(sizeof(struct points) <= POINTS_BYTES, "rows of the binary log have a fixed size");

static inline const char *points_show_name(uint32_t show)
{
	static const char *const names[POINTS_SHOWS] = {"real", "in-between", "repeat", "standby", "kept"};
	return show < POINTS_SHOWS ? names[show] : "unknown";
}

static inline const char *point_name(uint32_t point)
{
	static const char *const names[POINT_COUNT] = {"submit", "intake", "target", "ready",  "flip",
												   "event",  "edge",   "photon", "trigger"};
	return point < POINT_COUNT ? names[point] : "unknown";
}

#endif
