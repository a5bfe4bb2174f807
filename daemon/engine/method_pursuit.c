/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/method.h"

/* A thirty-second of a pixel does not show, and most cells of a scene seen in perspective differ by less. */
#define PURSUIT_TOLERANCE (1.0f / 32.0f)

const struct method method_pursuit = {
	.name = "pursuit",
	.description = "the best there is: at present grid, with cells merged where they move alike",
	.tolerance = PURSUIT_TOLERANCE,
	.begin = grid_begin,
	.show = grid_show,
};
