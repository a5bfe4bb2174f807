/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Between the last two real frames, one frame late (docs/method.md, 9.6). */
#include "daemon/engine/method_pixels.h"

#include <math.h>
#include <string.h>

#include "daemon/engine/pass.h"
#include "daemon/engine/pixels/between.h"

static int paint_before(struct engine *engine, struct error *error)
{
	const struct bitmap *before = &pixel_state_before(&engine->pixels)->bitmap;
	memcpy(engine->pixels.shown.data, before->data, 4 * (size_t)before->width * before->height);
	return 0;
}

static int paint(struct engine *engine, struct error *error)
{
	struct pixel_state *state = &engine->pixels;
	const struct pixel_frame *now = pixel_state_now(state), *before = pixel_state_before(state);
	const struct between_frame frames[2] = {{&now->dense, &now->bitmap}, {&before->dense, &before->bitmap}};
	return between_show(&state->scatter, &frames[0], &frames[1], engine->job.phase, &state->shown, error);
}

static int interpolate_begin(struct engine *engine, struct error *error)
{
	report_leave_out(&engine->report, "extrapolation", "method");
	return pixels_begin(engine, error);
}

static int interpolate_show(struct engine *engine, enum engine_show show, double phase, enum picture_id *picture,
							struct error *error)
{
	const struct pixel_state *state = &engine->pixels;
	const enum plan_rest rest = pixel_state_now(state)->dense.rest;
	const double share = fmin(fmax(phase, 0.0), 1.0);
	*picture = PICTURE_ORIGINAL;
	if (!pixel_state_before(state))
		return 0;
	const bool same = show == ENGINE_SHOW_PLAIN || (show == ENGINE_SHOW_REAL && fabs(phase) <= METHOD_SAME_MOMENT);
	const bool held = rest != PLAN_MOVES && rest != PLAN_STILL;
	return pixels_show(engine, same || held ? paint_before : paint, share, picture, error);
}

const struct method method_interpolate = {
	.name = "interpolate",
	.description = "between the last two real frames, one real frame late",
	.lag = 1,
	.begin = interpolate_begin,
	.show = interpolate_show,
};
