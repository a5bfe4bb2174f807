/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The order of the motion models (docs/method.md, 10), measured where the truth is known: things that move along an
 * exact path, the displacement that the plan gives their vertices, and where they really are.
 */
#ifndef PURSUIT_ENGINE_MOTION_ORDER_H
#define PURSUIT_ENGINE_MOTION_ORDER_H

#include "daemon/engine/engine.h"

enum motion_path {
	MOTION_PATH_FAN = 0,  /* turns with 2 radians a second; within 60 pixels of its hub */
	MOTION_PATH_PARABOLA, /* everything at 60, -20 pixels a second and speeds up by 300, 900 a second */
	MOTION_PATH_CUBIC,    /* as the parabola, and by another 4000, -2000 each second */
	MOTION_PATH_COUNT,
};

/* Static. */
const char *motion_path_name(enum motion_path path);

/*
 * The largest distance of a vertex from the truth, in pixels, when it is extrapolated to the phase from two frames
 * whose motion spans `interval_s` (1/240 to 1/10), the real interval, and that lie `gap` (1 to 8) such intervals apart:
 * those between them were lost. Negative with a sentence if memory is out.
 */
double motion_order_error(enum motion_path path, enum engine_motion_model model, double interval_s, uint32_t gap,
						  double phase, struct error *error);

#endif
