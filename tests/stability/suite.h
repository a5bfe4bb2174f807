/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * One program, one context: the cases that a method could break on, each with
 * the bound that it must keep (docs/method.md). A case looks at the engine's
 * pictures against the reference, or at what must hold for any method.
 */
#ifndef PURSUIT_STABILITY_SUITE_H
#define PURSUIT_STABILITY_SUITE_H

#include "table.h"
#include "tests/reference/engine-case.h"
#include "tests/reference/input.h"

struct suite {
	struct engine *engine;
	struct table table;
	bool complete; /* also what takes minutes */
};

/* B G R A of one displayed frame, rows packed; freed by the caller. */
uint8_t *suite_render(struct suite *suite, const struct frame *frame, enum engine_show show, double phase,
					  uint32_t *width, uint32_t *height);

/* Sets the method (and its defaults) for frames of this width, with no memory of frames before. */
void suite_method(struct suite *suite, const char *method, uint32_t width);

/* Steps by which any pixel leaves what the reference allows; all requests of a usual frame. Bound 0. */
void suite_against_reference(struct suite *suite, const char *name, const struct frame *frame,
							 const struct engine_params *params, double last_phase);

/* Every method shows the frame: without an error, each pixel written, the same bits twice. Bound 0 pixels. */
void suite_all_methods(struct suite *suite, const char *name, const struct frame *frame);

/* Where a plane of a frame for tests can be written; its rows are stride bytes apart. It must be there. */
uint8_t *suite_plane(const struct input *input, uint32_t role, const struct pursuit_plane **plane);

/* Motion (RG32F) of every pixel by its centre. */
void suite_move(const struct input *input, void (*motion)(void *context, double x, double y, double m[2]),
				void *context);

void compensation_run(struct suite *suite);
void motion_run(struct suite *suite);
void geometry_run(struct suite *suite);
void sizes_run(struct suite *suite);
void numbers_run(struct suite *suite);
void time_run(struct suite *suite);

#endif
