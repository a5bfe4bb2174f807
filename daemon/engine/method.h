/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A method: a way to make displayed frames from a real one. One file each. */
#ifndef PURSUIT_ENGINE_METHOD_H
#define PURSUIT_ENGINE_METHOD_H

#include "daemon/engine/state.h"

/* The functions are mandatory and called after the executor was entered, on the engine's thread. */
struct method {
	const char *name;
	const char *description; /* one line */
	float tolerance;         /* of merged cells (merge.h), pixels */
	bool halves_cells;       /* its finest cells are half of those asked for, at least 4 pixels */
	bool blurs_everywhere;   /* unless the blur is off */
	uint32_t lag;            /* real frames that it shows late */
	/* Colour and UI are uploaded; the frame's planes are still there. 0 or a negative errno with a sentence. */
	int (*begin)(struct engine *engine, struct error *error);
	/* Makes the picture, without UI, and says where it is. */
	int (*show)(struct engine *engine, enum engine_show show, double phase, enum picture_id *picture,
				struct error *error);
};

extern const struct method method_hold, method_black, method_blur_hold, method_mcif, method_interpolate, method_scatter,
	method_grid, method_adaptive_grid, method_pursuit;

/* Closer to the real frame's own moment than this, it is shown undisplaced. */
#define METHOD_SAME_MOMENT 0.05

/* A thirty-second of a pixel does not show, and most cells of a scene seen in perspective differ by less. */
#define METHOD_TOLERANCE (1.0f / 32.0f)

/* By name, NULL: the default. NULL with a sentence that lists all. */
const struct method *method_find(const char *name, struct error *error);

/* k (docs/method.md, 6) of the frame in engine->job. */
double method_boost(const struct engine *engine);
/* L, E and B, where the blur and the boost need them; notes why not. 0 or the passes' error. */
int method_make_layers(struct engine *engine, struct error *error);

/* For methods that build upon `grid`. */
int grid_begin(struct engine *engine, struct error *error);
int grid_show(struct engine *engine, enum engine_show show, double phase, enum picture_id *picture,
			  struct error *error);

#endif
