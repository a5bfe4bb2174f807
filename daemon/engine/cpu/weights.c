/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/cpu/weights.h"

#include <math.h>

/* The first pixel whose centre is not before `at`, within 0 to size. */
static uint32_t first_centre(double at, uint32_t size)
{
	double first = ceil(at - 0.5);
	return first > 0.0 ? first < (double)size ? (uint32_t)first : size : 0;
}

/* Where an edge crosses the centre of a row: the same for both triangles that share it. */
static double cross(const struct weights_corner *a, const struct weights_corner *b, uint32_t row)
{
	const struct weights_corner *top = a->y <= b->y ? a : b, *bottom = a->y <= b->y ? b : a;
	return top->x + ((double)row + 0.5 - top->y) * ((bottom->x - top->x) / (bottom->y - top->y));
}

void weights_put(const struct weights *weights, const struct weights_corner corners[3], uint16_t value)
{
	double top = fmin(corners[0].y, fmin(corners[1].y, corners[2].y));
	double bottom = fmax(corners[0].y, fmax(corners[1].y, corners[2].y));
	uint32_t end = first_centre(bottom, weights->height);
	for (uint32_t row = first_centre(top, weights->height); row < end; row++) {
		double centre = (double)row + 0.5, left = 0.0, right = 0.0;
		for (int i = 0; i < 3; i++) {
			const struct weights_corner *from = &corners[i], *to = &corners[(i + 1) % 3];
			/* What turns the positive way goes down on its right. */
			if (from->y <= centre && centre < to->y)
				right = cross(from, to, row);
			else if (to->y <= centre && centre < from->y)
				left = cross(from, to, row);
		}
		uint32_t last = first_centre(right, weights->width);
		for (uint32_t i = first_centre(left, weights->width); i < last; i++)
			weights->values[(size_t)row * weights->width + i] = value;
	}
}
