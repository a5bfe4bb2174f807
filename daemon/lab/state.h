/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The lab's inside, private to lab.c (life, feeding), thread.c (the loop), outputs.c, inputs.c and status.c. */
#ifndef PURSUIT_LAB_STATE_H
#define PURSUIT_LAB_STATE_H

#include <pthread.h>

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

struct lab {
	struct lab_params params;
	const struct lab_settings *settings;
	struct code *code;
	struct queue flips, render;
	int wake_fd; /* eventfd */
	pthread_t thread;
	atomic_bool stop, realtime;
	struct guard guard;
	struct latency_log *latency_log;
	struct vsync *vsync; /* NULL: none is wished for */
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

/* ---- thread.c ---- */

void *lab_run(void *lab);

/* ---- outputs.c ---- */

void outputs_init(struct lab *lab);
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
/* A flip that changes the patch (or nothing is known about its light); the row waits for the light. */
void inputs_flip(struct lab *lab, struct row *row, bool changed);
/* Reads edges of lines that have some (`readable`), matches them, keeps lines alive. */
void inputs_work(struct lab *lab, uint64_t now_ns);
uint64_t inputs_next(const struct lab *lab);
void inputs_finish(struct lab *lab);

#endif
