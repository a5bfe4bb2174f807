/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The lab: marks flips on GPIO lines, flashes a backlight, watches inputs,
 * draws the photodiode patch and keeps all time points of every displayed
 * frame. All on a thread of its own, with real-time priority where that is
 * permitted; those who feed it never wait. With no option of the lab set there
 * is no lab at all. Every function but lab_create() accepts NULL and then does
 * nothing.
 *
 * Times of lines: an edge is known to lie between the start of the call that
 * sets the line and its end; POINT_EDGE is the end, set_ns the length.
 */
#ifndef PURSUIT_LAB_LAB_H
#define PURSUIT_LAB_LAB_H

#include <jansson.h>

#include "daemon/clock.h"
#include "daemon/error.h"
#include "daemon/lab/points.h"
#include "daemon/lab/settings.h"
#include "daemon/log.h"
#include "daemon/present/presenter.h"
#include "daemon/present/vsync.h"

struct lab;

struct lab_params {
	const struct lab_settings *settings; /* must live as long */
	struct clock *clock;                 /* the real one: threads wait with the kernel's */
	const struct log *log;
	double period_ns;   /* of the refresh that is wished for; the display's own is learned from flips */
	const char *header; /* lines for the top of the latency log: version, settings */
};

/* Does any setting need it? */
bool lab_is_wanted(const struct lab_settings *settings);

/*
 * Checks what can be checked without hardware and starts the thread. A chip
 * that is not there or a line that is busy is no error: it is logged and tried
 * again. NULL with a sentence. Signals must be blocked by then (the thread
 * inherits the mask), and no other thread may run (it may fork a guard).
 */
struct lab *lab_create(const struct lab_params *params, struct error *error);
/* Lines get their final levels, the log is completed. Call when nobody feeds it any more. */
void lab_destroy(struct lab **lab);

/* The external vsync that the lab reads, for presenters; NULL: none is wished for. Lives as long as the lab. */
struct vsync *lab_get_vsync(struct lab *lab);

/* ---- the presenter's thread; no wait ---- */

void lab_flip(struct lab *lab, const struct presenter_flip *flip);

/* ---- the render thread; no wait ---- */

/*
 * A picture that is about to be queued for this vblank (a standby picture: the
 * vblank of its real frame): its patch is drawn (image->holds is 0 then), its
 * number noted.
 */
void lab_mark_picture(struct lab *lab, struct presenter_image *image, uint64_t serial, uint64_t vblank,
					  enum points_show show);
/* Does it draw patches at all? Then a picture must be in CPU memory. NULL: no. */
bool lab_draws(const struct lab *lab);
/* A vblank is over: what the render thread knows about it (all but flip, event, edge, photon). */
void lab_tell(struct lab *lab, const struct points *points);

/* ---- any thread ---- */

/*
 * {"realtime", "log", "gpio": {...}, "spans": {name: {count, mean, p50, p99, max}}, ...}: what `pursuit top` shows.
 * NULL without a lab or memory.
 */
json_t *lab_status_json(struct lab *lab);
/*
 * {"first", "total", "columns", "rows": [[...], ...]}: at most count settled rows from number `from`, in the columns of
 * the CSV log; a time that is unknown is null. NULL without a lab or memory.
 */
json_t *lab_rows_json(struct lab *lab, uint64_t from, uint64_t count);

#endif
