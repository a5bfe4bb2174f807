/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The quadratic motion model (docs/method.md, 10): the change of each vertex' motion since the frame before, so that
 * things that turn or speed up are followed along a parabola. Vertices of a plan get, for each phase, the displacement
 * that leads there in a straight line: whoever draws them knows nothing of it.
 */
#ifndef PURSUIT_ENGINE_BEND_H
#define PURSUIT_ENGINE_BEND_H

#include <stdbool.h>

#include "daemon/engine/analysis/motion_plane.h"

struct bend_vector {
	float x, y;
};

/* The frame taken last. */
struct bend_before {
	bool known;                 /* there is one */
	uint64_t frame_id, time_ns; /* as its header says */
	double motion_s;            /* S', 0 unknown */
	enum plan_rest rest;        /* PLAN_MOVES: `motion` is its */
	bool backward;              /* its motion led from the frame before it */
	uint32_t width, height;     /* of colour */
	struct plan_motion_plane motion;
};

/* Memory that is kept from frame to frame; zeroed: nothing is known of a frame before. */
struct bend {
	struct bend_before before;
	struct bend_vector *straight, *change; /* u and a, by vertex of the plan; pixels per interval */
	float span;                            /* S / T */
	uint32_t capacity;
	uint32_t bent;      /* vertices with a change */
	const char *reason; /* why none has (docs/method.md, 8), if the frame moves; NULL: some have. Static */
	const struct plan_kernels *kernels; /* of the machine, found with the first frame */
};

/*
 * Takes the frame that the plan was made from with the same params, and finds `change`. 0 or -ENOMEM with a sentence;
 * then nothing is known of it.
 */
int bend_begin(struct bend *bend, const struct frame *frame, const struct plan *plan, const struct plan_params *params,
			   struct error *error);

/* Makes the plan's displacements those of u_p, p = phase. For the plan of bend_begin() only. */
void bend_apply(const struct bend *bend, struct plan *plan, double phase);

/* What comes next has nothing to do with what was before. */
void bend_forget(struct bend *bend);
/* Memory that it holds. */
uint64_t bend_bytes(const struct bend *bend);
void bend_finish(struct bend *bend);

#endif
