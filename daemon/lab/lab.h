/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The lab: marks flips on GPIO lines, flashes a backlight, watches inputs,
 * draws the photodiode patch and keeps all time points of every displayed
 * frame. All on a thread of its own, with real-time priority where that is
 * permitted; those who feed it never wait. With no option of the lab set it
 * sleeps: no thread, no process, nothing open. Every function but lab_create()
 * accepts NULL and then does nothing.
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
struct latency_log;

struct lab_params {
	const struct lab_settings *settings; /* copied */
	struct clock *clock;                 /* the real one: threads wait with the kernel's */
	const struct log *log;
	double period_ns;   /* of the refresh that is wished for; the display's own is learned from flips */
	const char *header; /* lines for the top of the latency log: version, settings */
};

/* Does any setting need it? */
bool lab_is_wanted(const struct lab_settings *settings);

/*
 * Checks what can be checked without hardware and starts the thread, if any setting needs it. A chip
 * that is not there or a line that is busy is no error: it is logged and tried
 * again. NULL with a sentence. Signals must be blocked by then (the thread
 * inherits the mask), and no other thread should run (it may fork a guard).
 */
struct lab *lab_create(const struct lab_params *params, struct error *error);
/* Lines get their final levels, the log is completed. Call when nobody feeds it any more. */
void lab_destroy(struct lab **lab);

/* Does it run? */
bool lab_is_active(const struct lab *lab);

/* The external vsync that the lab reads, for presenters; not trusted without a line. Lives as long as the lab. */
struct vsync *lab_get_vsync(struct lab *lab);

/*
 * Other settings while it runs, in two steps: opens lines and log that are new beside those that there are; then takes
 * them over between two flips, or leaves all as it was. Lines that stay the same are not touched, rows go on. A line
 * that is wanted anew while it is in use (with other lines, or the other level) is given up for that, about a
 * millisecond, in the first step, and taken back if that fails. 0, or a negative errno with a sentence (unlike at the
 * start, a line that is not there is an error): nothing has changed, and the second step is left out. header and
 * period_ns as in lab_params. On one thread, that of lab_create(); waits for the lab's thread.
 */
int lab_prepare(struct lab *lab, const struct lab_settings *fresh, double period_ns, const char *header,
				struct error *error);
/* The latency log of before, NULL none, is the caller's to close: latency_log_destroy(). */
struct latency_log *lab_commit(struct lab *lab);
void lab_abandon(struct lab *lab);

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
 * NULL without a lab that runs, or memory.
 */
json_t *lab_status_json(struct lab *lab);
/*
 * {"first", "total", "columns", "rows": [[...], ...]}: at most count settled rows from number `from`, in the columns of
 * the CSV log; a time that is unknown is null. NULL without a lab that runs, or memory.
 */
json_t *lab_rows_json(struct lab *lab, uint64_t from, uint64_t count);

#endif
