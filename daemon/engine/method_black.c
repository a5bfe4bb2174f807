/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Black data insertion (docs/method.md, 9.2; Didyk et al. 2010, Section 4). */
#include "daemon/engine/method_pixels.h"
#include "daemon/engine/pass.h"

static int paint(struct engine *engine, struct error *error)
{
	const struct bitmap *shown = &engine->pixels.shown;
	static const uint8_t black[4] = {0, 0, 0, 255};
	for (size_t i = 0; i < 4 * (size_t)shown->width * shown->height; i++)
		shown->data[i] = black[i % 4];
	return 0;
}

static int black_begin(struct engine *engine, struct error *error)
{
	report_leave_out(&engine->report, "extrapolation", "method");
	return 0;
}

static int black_show(struct engine *engine, enum engine_show show, double phase, enum picture_id *picture,
					  struct error *error)
{
	*picture = PICTURE_ORIGINAL;
	return show == ENGINE_SHOW_IN_BETWEEN ? pixels_show(engine, paint, phase, picture, error) : 0;
}

const struct method method_black = {
	.name = "black",
	.description = "the real frame, then black (black data insertion)",
	.begin = black_begin,
	.show = black_show,
};
