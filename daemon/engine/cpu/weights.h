/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The blur weight w of each pixel, from the undisplaced triangles that have one (docs/method.md, 5). */
#ifndef PURSUIT_ENGINE_CPU_WEIGHTS_H
#define PURSUIT_ENGINE_CPU_WEIGHTS_H

#include <stddef.h>
#include <stdint.h>

/* Row by row; 65535 stands for 1. */
struct weights {
	uint32_t width, height;
	uint16_t *values;
	size_t capacity;
};

struct weights_corner {
	double x, y; /* pixels */
};

/* Gives the pixels whose centres lie in a triangle that turns the positive way a weight. */
void weights_put(const struct weights *weights, const struct weights_corner corners[3], uint16_t value);

#endif
