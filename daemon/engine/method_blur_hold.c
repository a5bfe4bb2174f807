/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Blurred duplicates, sharpened originals, no motion (docs/method.md, 9.3; Didyk et al. 2010, Section 4). */
#include "daemon/engine/method.h"
#include "daemon/engine/pass.h"

static int blur_hold_begin(struct engine *engine, struct error *error)
{
	report_leave_out(&engine->report, "extrapolation", "method");
	engine->levels_everywhere = true;
	engine->boost = method_boost(engine);
	int result = warp_mesh_begin_tiles(&engine->mesh, engine->width, engine->height, engine->params.blur_level, error);
	return result < 0 ? result : method_make_layers(engine, error);
}

static int blur_hold_show(struct engine *engine, enum engine_show show, double phase, enum picture_id *picture,
						  struct error *error)
{
	*picture = PICTURE_ORIGINAL;
	if (show != ENGINE_SHOW_PLAIN && engine->compensated)
		*picture = show == ENGINE_SHOW_REAL ? PICTURE_REAL : PICTURE_BETWEEN;
	return 0;
}

const struct method method_blur_hold = {
	.name = "blur-hold",
	.description = "repeats the real frame blurred, makes up for it in the real one",
	.blurs_everywhere = true,
	.begin = blur_hold_begin,
	.show = blur_hold_show,
};
