/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Which pixel of a frame shows where at a phase (docs/method.md, 9.5; Yu et al. 2010). */
#ifndef PURSUIT_PIXELS_SCATTER_H
#define PURSUIT_PIXELS_SCATTER_H

#include "daemon/engine/analysis/dense.h"
#include "daemon/engine/pixels/bitmap.h"
#include "daemon/engine/pixels/pull_push.h"

#define SCATTER_HOLE UINT32_MAX

/* Memory that is kept from frame to frame; zeroed at first. */
struct scatter {
	uint32_t width, height;
	uint32_t *source; /* by target pixel: index of the source pixel, or SCATTER_HOLE */
	uint32_t holes;
	float *values; /* B G R, or u, by target pixel, on their way to a picture */
	uint8_t *valid;
	size_t capacity; /* pixels */
	struct pull_push fill;
};

/* Fills `source`. 0 or -ENOMEM with a sentence. */
int scatter_make(struct scatter *scatter, const struct plan_dense *dense, double phase, struct error *error);

/* The picture at the phase that `scatter` was made for, of the same size. 0 or -ENOMEM with a sentence. */
int scatter_show(struct scatter *scatter, const struct plan_dense *dense, double phase, const struct bitmap *from,
				 struct bitmap *to, struct error *error);

void scatter_finish(struct scatter *scatter);

#endif
