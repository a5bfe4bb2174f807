/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Frames sharpened along their motion and held (docs/method.md, 9.4; Klompenhouwer and Velthoven 2004). */
#include "daemon/engine/method_pixels.h"
#include "daemon/engine/pass.h"
#include "daemon/engine/pixels/inverse_filter.h"

static int paint(struct engine *engine, struct error *error)
{
	const struct pixel_frame *frame = pixel_state_now(&engine->pixels);
	inverse_filter(&frame->dense, &frame->bitmap, &engine->pixels.shown);
	return 0;
}

static int mcif_begin(struct engine *engine, struct error *error)
{
	int result = pixels_begin(engine, error);
	if (result < 0)
		return result;
	report_leave_out(&engine->report, "extrapolation", "method");
	engine->job.paint = paint;
	return engine->moves ? pass_run(engine, PASS_PAINT, error) : 0;
}

static int mcif_show(struct engine *engine, enum engine_show show, double phase, enum picture_id *picture,
					 struct error *error)
{
	const bool plain = show == ENGINE_SHOW_PLAIN || !engine->moves;
	*picture = plain ? PICTURE_ORIGINAL : PICTURE_SHOWN;
	/* Each time: the UI was laid over it. */
	return plain ? 0 : pass_run(engine, PASS_PUT, error);
}

const struct method method_mcif = {
	.name = "mcif",
	.description = "repeats the real frame, sharpened along its motion",
	.begin = mcif_begin,
	.show = mcif_show,
};
