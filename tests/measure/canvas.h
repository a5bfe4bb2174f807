/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Small pictures for the tests of measures. */
#ifndef PURSUIT_TESTS_MEASURE_CANVAS_H
#define PURSUIT_TESTS_MEASURE_CANVAS_H

#include <stdint.h>
#include <string.h>

#include "daemon/measure/measure.h"

#define CANVAS_MOST 64u

struct canvas {
	uint8_t data[CANVAS_MOST * CANVAS_MOST * 4];
	struct picture picture;
};

/* All pixels of one grey. */
static inline void canvas_init(struct canvas *canvas, uint32_t width, uint32_t height, uint8_t grey)
{
	memset(canvas->data, grey, sizeof(canvas->data));
	canvas->picture = (struct picture){canvas->data, 4 * (size_t)width, width, height};
}

static inline void canvas_set(struct canvas *canvas, uint32_t x, uint32_t y, uint8_t grey)
{
	memset(canvas->data + 4 * ((size_t)y * canvas->picture.width + x), grey, 3);
}

/* A column of one grey. */
static inline void canvas_column(struct canvas *canvas, uint32_t x, uint8_t grey)
{
	for (uint32_t y = 0; y < canvas->picture.height; y++)
		canvas_set(canvas, x, y, grey);
}

#endif
