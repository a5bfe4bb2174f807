/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/method.h"

const struct method method_pursuit = {
	.name = "pursuit",
	.description = "the best there is: at present `grid`",
	.begin = grid_begin,
	.show = grid_show,
};
