/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The lab's inside, private to lab.c (life, feeding), thread.c (the loop), outputs.c, inputs.c and status.c. */
#ifndef PURSUIT_LAB_STATE_H
#define PURSUIT_LAB_STATE_H

#include <pthread.h>
#include <semaphore.h>

#include "daemon/lab/code.h"
#include "daemon/lab/guard.h"
#include "daemon/lab/lab.h"
#include "daemon/lab/latency_log.h"
#include "daemon/lab/lines.h"
#include "daemon/lab/match.h"
#include "daemon/lab/pattern.h"
#include "daemon/lab/queue.h"
#include "daemon/lab/rows.h"
#include "daemon/lab/spans.h"
#include "daemon/lab/strobe.h"

#define LAB_PICTURES 64u
#define LAB_RING 4096u
#define LAB_TRIGGERS 32u
#define LAB_NEVER UINT64_MAX

/* What other threads may read, under a lock that hands priority down. Filled as rows settle. */
struct lab_shared {
	pthread_mutex_t lock;
	struct points ring[LAB_RING];
	uint64_t row_count;
	struct spans spans;
	char marker[256], strobe[256], photodiode[256], trigger[256], vsync[256];
	bool marker_there, strobe_there, photodiode_there, trigger_there, vsync_there;
	uint64_t edges, late_changes, schedule_dropped, stray_photons, bounced, triggers;
	uint64_t strobe_pulses, strobe_left_out, strobe_too_long;
	uint32_t levels;
};

/* The lines of a lab, in the order of lab_line(). */
#define LAB_LINES 5u

/* What lab_prepare() has made. */
struct lab_prepared {
	struct lab_settings settings;
	double period_ns; /* 0: as before */
	struct {
		bool other;        /* than there is */
		bool early;        /* let go of already, to be taken back or exchanged */
		struct chip *chip; /* NULL: none */
	} lines[LAB_LINES];
	char marker_chip[CHIP_NAME_BYTES]; /* which the marker's lines that were let go of were on */
	bool other_log, other_guard, started;
	struct latency_log *latency_log;
	struct guard guard;
};

struct lab {
	struct lab_params params;
	struct lab_settings settings; /* change only while the thread is parked */
	_Atomic uint32_t patch;       /* the same for the render thread: patch, corner << 2, size << 4 */
	atomic_bool active;           /* the thread runs, and wants to know of flips */
	bool running;                 /* there is a thread; the owner's */
	atomic_bool park;             /* it is to stand still between two flips */
	sem_t parked, go_on;
	struct lab_prepared prepared;
	struct code *code;
	struct queue flips, render;
	int wake_fd; /* eventfd */
	pthread_t thread;
	atomic_bool stop, realtime;
	struct guard guard;
	struct latency_log *latency_log;
	struct vsync *vsync;
	struct lab_shared shared;

	/* the thread's own */
	struct lines marker, strobe_lines, photodiode, trigger, vsync_lines;
	struct pattern pattern;
	struct schedule schedule;
	uint32_t levels; /* of the marker, as set */
	uint64_t edges, late_changes;
	struct strobe strobe;
	uint64_t strobe_due_ns, strobe_off_ns; /* LAB_NEVER: none */
	struct match match;
	uint64_t trigger_ns[LAB_TRIGGERS]; /* edges whose flip is still to come, as they came */
	uint32_t trigger_count;
	uint64_t triggers; /* ever */
	struct lab_picture pictures[LAB_PICTURES];
	bool front_level; /* of the patch on display */
	uint32_t front_code;
	struct rows rows;
	uint64_t publish_ns; /* rows are not handed on before: somebody reads */
	double period_ns;
	uint64_t last_vblank, last_target_ns;
	bool woken; /* the eventfd has something to be read */
};

/* ---- lab.c ---- */

/* What can be checked without hardware. 0 or -EINVAL with a sentence. */
int lab_check(const struct lab_settings *settings, struct error *error);
/* 0 or a negative errno with a sentence. */
int lab_start_thread(struct lab *lab, struct error *error);
/* Lines get their final levels, what was fed has been read. */
void lab_stop_thread(struct lab *lab);
/* The thread looks at what was fed. */
void lab_wake(struct lab *lab);
/* For the render thread. */
void lab_publish_patch(struct lab *lab);

/* ---- thread.c ---- */

void *lab_run(void *lab);
/* As the settings say, where that is permitted. */
void lab_set_priority(struct lab *lab, pthread_t thread);

/* ---- outputs.c ---- */

void outputs_init(struct lab *lab);
/* What the settings want of the marker's and the strobe's lines. */
struct lines outputs_marker(const struct lab *lab, const struct lab_settings *settings);
struct lines outputs_strobe(const struct lab *lab, const struct lab_settings *settings);
/* The settings are new; lines as they are, or (`other`) just exchanged. Counts go on. */
void outputs_change(struct lab *lab, bool other_marker, bool other_strobe);
/* The marker's or strobe's line goes: edges that were due are lost, levels are safe and final. */
void outputs_leave_marker(struct lab *lab);
void outputs_leave_strobe(struct lab *lab);
/* A flip: plans the marker's change and the strobe's pulse. Does the marker get an edge? */
bool outputs_flip(struct lab *lab, const struct pattern_flip *flip);
/* Does what is due now; each reading of the clock is a call that an edge may wait for. */
void outputs_work(struct lab *lab, uint64_t now_ns);
/* When outputs_work() has something to do. */
uint64_t outputs_next(const struct lab *lab);
/* Safe and final levels. */
void outputs_finish(struct lab *lab);

/* ---- inputs.c ---- */

void inputs_init(struct lab *lab);
/* What the settings want of an input's line: 0 photodiode, 1 trigger, 2 vsync. */
struct lines inputs_line(const struct lab *lab, const struct lab_settings *settings, unsigned which);
/* The settings are new. */
void inputs_change(struct lab *lab);
/* A flip that changes the patch (or nothing is known about its light); the row waits for the light. */
void inputs_flip(struct lab *lab, struct row *row, bool changed);
/* Reads edges of lines that have some (`readable`), matches them, keeps lines alive. */
void inputs_work(struct lab *lab, uint64_t now_ns);
uint64_t inputs_next(const struct lab *lab);
void inputs_finish(struct lab *lab);

#endif
