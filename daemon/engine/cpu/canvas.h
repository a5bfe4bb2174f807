/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A picture in memory: BGRA pixels with a border that repeats the outermost
 * ones, so that filters need not look where they are.
 */
#ifndef PURSUIT_ENGINE_CPU_CANVAS_H
#define PURSUIT_ENGINE_CPU_CANVAS_H

#include <stddef.h>
#include <stdint.h>

#include "daemon/error.h"

/* Pixels that repeat the outermost one, on each side. */
#define CANVAS_BORDER 2u

struct canvas {
	uint32_t width, height; /* 0: nothing there */
	size_t stride;          /* bytes */
	uint8_t *pixels;        /* pixel (0, 0), 64-byte aligned, as is each row */
	void *memory;
	size_t capacity;
};

/* Makes it that size; what is in it is undefined afterwards if it changes. Memory grows and stays. 0 or -ENOMEM. */
int canvas_resize(struct canvas *canvas, uint32_t width, uint32_t height, struct error *error);
void canvas_finish(struct canvas *canvas);

static inline uint8_t *canvas_row(const struct canvas *canvas, int64_t y)
{
	return canvas->pixels + y * (int64_t)canvas->stride;
}

/* Renews the border beside a row, and above or below it if it is the first or the last. */
void canvas_close_row(const struct canvas *canvas, uint32_t y);

#endif
