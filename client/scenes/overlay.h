/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The UI layer as a list of rectangles in pixels (x right, y down from the top
 * left corner), colours premultiplied. Text is a 5x7 pixel font, drawn at
 * whole multiples, so that it is sharp at every size.
 */
#ifndef PURSUIT_SCENES_OVERLAY_H
#define PURSUIT_SCENES_OVERLAY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct overlay_vertex {
	float position[2];
	float uv[2];
	uint8_t color[4];
};

struct overlay {
	struct overlay_vertex *vertices; /* triangles */
	size_t count, capacity;
	double width, height;
	double unit; /* pixels per font pixel: whole, at least 1 */
	bool failed;
};

#define OVERLAY_ATLAS_WIDTH 128
#define OVERLAY_ATLAS_HEIGHT 64

void overlay_begin(struct overlay *overlay, uint32_t width, uint32_t height);
void overlay_finish(struct overlay *overlay);

/* color is 0xRRGGBB, alpha 0 to 1. */
void overlay_rectangle(struct overlay *overlay, double x, double y, double width, double height, uint32_t color,
					   double alpha);
void overlay_frame(struct overlay *overlay, double x, double y, double width, double height, double line,
				   uint32_t color, double alpha);
/* A straight bar of the given thickness between two points. */
void overlay_line(struct overlay *overlay, double x0, double y0, double x1, double y1, double thickness, uint32_t color,
				  double alpha);
/* Capital letters, digits and common signs; returns the width. */
double overlay_text(struct overlay *overlay, double x, double y, double scale, uint32_t color, const char *text);

/* The glyphs as an R8 picture; texel (0, 0) is solid. */
void overlay_fill_atlas(uint8_t *pixels);
uint64_t overlay_hash(const struct overlay *overlay);

#endif
