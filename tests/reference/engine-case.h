/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* One real frame through the engine and through the reference, and the pictures of both compared. */
#ifndef PURSUIT_REFERENCE_ENGINE_CASE_H
#define PURSUIT_REFERENCE_ENGINE_CASE_H

#include "bounds.h"

/* Share of pixels with |engine - reference| <= 1 step where nothing but the last rounding is open. */
#define CASE_PLAIN_WITHIN_ONE 0.999

struct engine_case {
	const char *name;
	struct engine_params params;
	struct engine_begin_params begin;
	const struct engine_request *requests;
	uint32_t request_count;
};

/* Sums over cases, by what is shown. */
struct case_totals {
	struct bounds_report reports[3]; /* ENGINE_SHOW_* */
	uint32_t cases, failed;
};

/*
 * Compares all requests of a case; prints a line for each picture with an
 * error. false if any call or any pixel is wrong.
 */
bool engine_case_run(struct engine *engine, const struct frame *frame, const struct engine_case *what,
					 struct case_totals *totals);

/* Prints the totals, a line for each kind of picture. */
void case_totals_print(const struct case_totals *totals);

#endif
