/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The passes of methods that work pixel by pixel: what they need, and what they make of it. */
#include "daemon/engine/analysis/rows.h"
#include "daemon/engine/pass.h"

#include <errno.h>

static int out_of_memory(const struct engine *engine, struct error *error)
{
	return error_set(error, -ENOMEM, "out of memory for a picture of %u x %u", engine->width, engine->height);
}

/* After the upload, which made the converter ready. */
static int copy_colour(const struct engine *engine, struct pixel_frame *frame, struct error *error)
{
	const struct frame *from = engine->job.frame;
	const int index = plan_find_plane(&from->header, PURSUIT_ROLE_COLOR);
	if (!bitmap_resize(&frame->bitmap, &frame->bytes, engine->width, engine->height))
		return out_of_memory(engine, error);
	for (uint32_t y = 0; y < engine->height; y++)
		convert_row(&engine->color_convert, frame->bitmap.data + 4 * (size_t)y * engine->width,
					from->planes[index] + y * from->header.planes[index].stride, engine->width, true);
	return 0;
}

static int run_field(struct engine *engine, struct error *error)
{
	struct pixel_state *state = &engine->pixels;
	const struct plan_params params = {
		.display_width_mm = engine->params.display_width_mm,
		.viewing_distance_mm = engine->params.viewing_distance_mm,
		.real_interval_ns = engine->real_interval_ns,
	};
	const struct bitmap last = pixel_state_now(state)->bitmap;
	const bool follows = state->count && last.width == engine->width && last.height == engine->height;
	state->now = 1 - state->now;
	struct pixel_frame *frame = &state->frames[state->now];
	state->count = 0;
	int result = plan_dense_make(&frame->dense, engine->job.frame, &params, error);
	if (result == 0)
		result = copy_colour(engine, frame, error);
	if (result == 0)
		state->count = follows ? 2 : 1;
	engine->report.invalid_pixels = frame->dense.invalid_pixels;
	return result;
}

static int run_paint(struct engine *engine, struct error *error)
{
	if (!bitmap_resize(&engine->pixels.shown, &engine->pixels.shown_bytes, engine->width, engine->height))
		return out_of_memory(engine, error);
	return engine->job.paint(engine, error);
}

const struct pass pass_field = {.on_cpu = true, .run = run_field};
const struct pass pass_paint = {.on_cpu = true, .run = run_paint};
