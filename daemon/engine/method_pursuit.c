/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/method.h"

const struct method method_pursuit = {
	.name = "pursuit",
	.description = "the best there is: at present grid, with cells merged where they move alike",
	.tolerance = METHOD_TOLERANCE,
	.begin = grid_begin,
	.show = grid_show,
};
