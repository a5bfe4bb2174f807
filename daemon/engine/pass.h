/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Running passes, and the report of what ran. */
#ifndef PURSUIT_ENGINE_PASS_H
#define PURSUIT_ENGINE_PASS_H

#include "daemon/engine/state.h"

/* Prepares, runs and times a pass of the engine's executor. 0, -ENOTSUP if it has none such, or the pass's error. */
int pass_run(struct engine *engine, enum pass_id id, struct error *error);

/* Depth and motion to the plan, on the CPU: the same for all executors. */
extern const struct pass pass_analyse;

/* What the plan is asked for, and what it takes besides the plan: the change of motion. */
struct plan_params analyse_params(const struct engine *engine);
int analyse_bend(struct engine *engine, const struct plan_params *params, struct error *error);

/* For methods that work pixel by pixel, on the CPU too (pixel_state.h). */
extern const struct pass pass_field, pass_paint;

/*
 * Colour and UI as the display's code values, for the upload of any executor: finds the planes, checks and converts.
 * Checks sizes, makes the converters ready and forgets the UI's bounds; *color and *ui: the planes' places in the
 * header, -1 without UI. 0 or -EINVAL with a sentence.
 */
int planes_prepare(struct engine *engine, int *color, int *ui, struct error *error);

/* Whether rows y to y + count - 1 of the planes may have changed since the frame before. */
bool planes_changed(const struct engine *engine, uint32_t y, uint32_t count);

/* The upload has found that they have not, though nobody said so: the frame counts as one without damage. */
void planes_find_unchanged(struct engine *engine);

/* Notes that something was left out; the first reason given for a name stays. */
void report_leave_out(struct engine_report *report, const char *name, const char *reason);
void report_begin(struct engine_report *report, uint64_t frame_id, const char *time_source);

#endif
