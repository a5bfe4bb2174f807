/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The analysis on the GPU, held against that on the CPU. */
#ifndef PURSUIT_TESTS_PLAN_ON_GPU_H
#define PURSUIT_TESTS_PLAN_ON_GPU_H

#include "daemon/engine/state.h"

struct on_gpu_totals {
	uint64_t plans, vertices, equal; /* equal: to the bit */
};

/* An engine that analyses in a context: surfaceless, gles, osmesa. NULL with a sentence where there is none. */
struct engine *on_gpu_open(const char *kind, struct error *error);

/* Analyses alone, into engine->plan; prints what fails. Colour need not be there. */
bool on_gpu_analyse(struct engine *engine, const struct frame *frame, const struct plan_params *params);

/*
 * Both analyses: the same vertices within rounding, the same triangles, counts and tiles. Prints what differs. Where
 * a renderer fuses multiplications and additions although asked not to, ties may be settled otherwise.
 */
bool on_gpu_alike(struct engine *engine, const struct frame *frame, const struct plan_params *params, const char *what,
				  struct on_gpu_totals *totals);

#endif
