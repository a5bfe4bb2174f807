/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Each pixel where it moves, by itself (docs/method.md, 9.5; Scherzer et al. 2011, Section 3.2). */
#include "daemon/engine/method_pixels.h"

#include <math.h>

static int paint(struct engine *engine, struct error *error)
{
	struct pixel_state *state = &engine->pixels;
	const struct pixel_frame *frame = pixel_state_now(state);
	int result = scatter_make(&state->scatter, &frame->dense, engine->job.phase, error);
	return result < 0
			   ? result
			   : scatter_show(&state->scatter, &frame->dense, engine->job.phase, &frame->bitmap, &state->shown, error);
}

static int scatter_method_show(struct engine *engine, enum engine_show show, double phase, enum picture_id *picture,
							   struct error *error)
{
	*picture = PICTURE_ORIGINAL;
	if (show == ENGINE_SHOW_PLAIN || !engine->moves || (show == ENGINE_SHOW_REAL && fabs(phase) <= METHOD_SAME_MOMENT))
		return 0;
	return pixels_show(engine, paint, phase, picture, error);
}

const struct method method_scatter = {
	.name = "scatter",
	.description = "each pixel moved by itself, holes filled by pull-push",
	.begin = pixels_begin,
	.show = scatter_method_show,
};
