/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What the reference would display if nothing were rounded: L, E, B and the
 * displayed picture in doubles (docs/method.md, 4, 6 and 7, without code8).
 * The original and the UI-free picture only: the UI takes no part in compensation.
 */
#ifndef PURSUIT_REFERENCE_EXACT_H
#define PURSUIT_REFERENCE_EXACT_H

#include "reference.h"

/* Code values, 0 to 1; B G R, packed rows. */
struct exact_picture {
	uint32_t width, height;
	double *data;
};

struct exact {
	const struct reference *reference;
	struct exact_picture low, real, between; /* L, E, B */
};

/* `reference` was begun and outlives `exact`. */
void exact_init(struct exact *exact, const struct reference *reference);
void exact_finish(struct exact *exact);

/* Code values of the displayed picture, B G R, 3 x width x height, the caller's. Real and in-between only. */
void exact_render(const struct exact *exact, const struct engine_request *request, double *codes);

#endif
