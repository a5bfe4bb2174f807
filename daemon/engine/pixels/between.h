/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A moment between two real frames, from both (docs/method.md, 9.6). */
#ifndef PURSUIT_PIXELS_BETWEEN_H
#define PURSUIT_PIXELS_BETWEEN_H

#include "daemon/engine/pixels/scatter.h"

/* One real frame as this method needs it. */
struct between_frame {
	const struct plan_dense *dense;
	const struct bitmap *bitmap;
};

/* Share 0 to 1 of the way from the frame before to the frame now, all of one size. 0 or -ENOMEM with a sentence. */
int between_show(struct scatter *scatter, const struct between_frame *now, const struct between_frame *before,
				 double share, struct bitmap *to, struct error *error);

#endif
