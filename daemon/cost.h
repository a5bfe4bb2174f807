/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What a piece of work costs: percentiles over its last runs. Pure; one thread.
 */
#ifndef PURSUIT_COST_H
#define PURSUIT_COST_H

#include <stdint.h>

#define COST_WINDOW 32u

/* Zeroed: nothing known, both estimates 0. */
struct cost {
	uint64_t runs_ns[COST_WINDOW];
	uint64_t count;
	uint64_t usual_ns; /* median */
	uint64_t safe_ns;  /* what nine of ten runs stay below, and a margin; at most 1.5 times the usual and 1 ms */
};

void cost_add(struct cost *cost, uint64_t run_ns);

#endif
