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

#include "daemon/engine/analysis/dense.h"

struct bend_vector {
	float x, y;
};

/* Memory that is kept from frame to frame; zeroed: nothing is known of a frame before. */
struct bend {
	struct plan_dense field;               /* of the frame taken last */
	bool known;                            /* there is one */
	struct bend_vector *straight, *change; /* u and a, by vertex of the plan; pixels per interval */
	uint32_t capacity;
	uint32_t bent; /* vertices with a change */
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
