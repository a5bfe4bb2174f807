/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Text and lines on a picture in CPU memory: BGRA8, rows top to bottom. Only written, never read; clipped. */
#ifndef PURSUIT_OVERLAY_H
#define PURSUIT_OVERLAY_H

#include <stddef.h>
#include <stdint.h>

struct overlay {
	uint8_t *data;
	size_t stride;
	uint32_t width, height;
};

enum overlay_place { OVERLAY_TOP_LEFT, OVERLAY_TOP_RIGHT, OVERLAY_CENTER, OVERLAY_BOTTOM_LEFT, OVERLAY_BOTTOM_RIGHT };

/* Pixels of a letter's dot: 2, more in large pictures, 1 in small ones. */
uint32_t overlay_scale(const struct overlay *overlay);

/* Lines of printable ASCII, divided by '\n', light on an opaque dark box. */
void overlay_text(const struct overlay *overlay, enum overlay_place place, const char *text);

/* Nothing but black. */
void overlay_blacken(const struct overlay *overlay);
/* A grey line from top to bottom at x. */
void overlay_divide(const struct overlay *overlay, uint32_t x);

#endif
