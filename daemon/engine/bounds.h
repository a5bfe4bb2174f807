/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Which part of a layer holds anything. */
#ifndef PURSUIT_ENGINE_BOUNDS_H
#define PURSUIT_ENGINE_BOUNDS_H

#include <stdbool.h>
#include <stdint.h>

/* A rectangle of pixels; empty if left >= right. */
struct bounds {
	uint32_t left, top, right, bottom;
};

static inline bool bounds_empty(const struct bounds *bounds)
{
	return bounds->left >= bounds->right;
}

/* Widens the bounds by what is not wholly transparent in row y of BGRA pixels. Rows in order from the top. */
void bounds_widen(struct bounds *bounds, const uint8_t *pixels, uint32_t width, uint32_t y);

#endif
