/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Sharpening along the motion against the blur of a held frame (docs/method.md, 9.4). */
#ifndef PURSUIT_PIXELS_INVERSE_FILTER_H
#define PURSUIT_PIXELS_INVERSE_FILTER_H

#include "daemon/engine/analysis/dense.h"
#include "daemon/engine/pixels/bitmap.h"

/* All of one size. */
void inverse_filter(const struct plan_dense *dense, const struct bitmap *from, struct bitmap *to);

#endif
