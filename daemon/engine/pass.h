/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The passes: one file each. A pass knows the engine's state and no other pass. */
#ifndef PURSUIT_ENGINE_PASS_H
#define PURSUIT_ENGINE_PASS_H

#include "daemon/engine/state.h"

/* Both functions are mandatory and called with the context current. */
struct pass {
	const char *name;
	bool on_cpu; /* GL does nothing in it */
	/* NULL if it has something to do, else why not (docs/method.md, 8). */
	const char *(*prepare)(struct engine *engine);
	/* 0 or a negative errno with a sentence. */
	int (*run)(struct engine *engine, struct error *error);
};

extern const struct pass pass_analyse, pass_upload, pass_pyramid, pass_compensate, pass_warp, pass_ui, pass_read;

/* Prepares, runs and times a pass. */
int pass_run(struct engine *engine, enum pass_id id, struct error *error);

/* Notes that something was left out; the first reason given for a name stays. */
void report_leave_out(struct engine_report *report, const char *name, const char *reason);
void report_begin(struct engine_report *report, uint64_t frame_id, const char *time_source);

#endif
