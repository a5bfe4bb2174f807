/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The grid, fine at motion edges and coarse elsewhere (docs/method.md, 9.7; Scherzer et al. 2011, Section 3.2). */
#include "daemon/engine/method.h"

const struct method method_adaptive_grid = {
	.name = "adaptive-grid",
	.description = "the grid with quads of 32 pixels that split at motion edges, down to 4",
	.tolerance = METHOD_TOLERANCE,
	.halves_cells = true,
	.begin = grid_begin,
	.show = grid_show,
};
