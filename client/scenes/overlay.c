/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "overlay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { GLYPH_WIDTH = 5, GLYPH_HEIGHT = 7, CELL = 8, FIRST = ' ', LAST = '_', COLUMNS = OVERLAY_ATLAS_WIDTH / CELL };

/* Rows from top to bottom, five bits each, the left pixel highest. */
static const uint8_t font[LAST - FIRST + 1][GLYPH_HEIGHT] = {
	{0, 0, 0, 0, 0, 0, 0},        {4, 4, 4, 4, 4, 0, 4},        {10, 10, 0, 0, 0, 0, 0},
	{10, 31, 10, 10, 31, 10, 0},  {4, 15, 20, 14, 5, 30, 4},    {24, 25, 2, 4, 8, 19, 3},
	{12, 18, 20, 8, 21, 18, 13},  {4, 4, 0, 0, 0, 0, 0},        {2, 4, 8, 8, 8, 4, 2},
	{8, 4, 2, 2, 2, 4, 8},        {0, 21, 14, 31, 14, 21, 0},   {0, 4, 4, 31, 4, 4, 0},
	{0, 0, 0, 0, 4, 4, 8},        {0, 0, 0, 31, 0, 0, 0},       {0, 0, 0, 0, 0, 12, 12},
	{0, 1, 2, 4, 8, 16, 0},       {14, 17, 19, 21, 25, 17, 14}, {4, 12, 4, 4, 4, 4, 14},
	{14, 17, 1, 2, 4, 8, 31},     {31, 2, 4, 2, 1, 17, 14},     {2, 6, 10, 18, 31, 2, 2},
	{31, 16, 30, 1, 1, 17, 14},   {6, 8, 16, 30, 17, 17, 14},   {31, 1, 2, 4, 8, 8, 8},
	{14, 17, 17, 14, 17, 17, 14}, {14, 17, 17, 15, 1, 2, 12},   {0, 12, 12, 0, 12, 12, 0},
	{0, 12, 12, 0, 12, 4, 8},     {2, 4, 8, 16, 8, 4, 2},       {0, 0, 31, 0, 31, 0, 0},
	{8, 4, 2, 1, 2, 4, 8},        {14, 17, 1, 2, 4, 0, 4},      {14, 17, 23, 21, 23, 16, 14},
	{14, 17, 17, 31, 17, 17, 17}, {30, 17, 17, 30, 17, 17, 30}, {14, 17, 16, 16, 16, 17, 14},
	{28, 18, 17, 17, 17, 18, 28}, {31, 16, 16, 30, 16, 16, 31}, {31, 16, 16, 30, 16, 16, 16},
	{14, 17, 16, 23, 17, 17, 15}, {17, 17, 17, 31, 17, 17, 17}, {14, 4, 4, 4, 4, 4, 14},
	{7, 2, 2, 2, 2, 18, 12},      {17, 18, 20, 24, 20, 18, 17}, {16, 16, 16, 16, 16, 16, 31},
	{17, 27, 21, 21, 17, 17, 17}, {17, 17, 25, 21, 19, 17, 17}, {14, 17, 17, 17, 17, 17, 14},
	{30, 17, 17, 30, 16, 16, 16}, {14, 17, 17, 17, 21, 18, 13}, {30, 17, 17, 30, 20, 18, 17},
	{15, 16, 16, 14, 1, 1, 30},   {31, 4, 4, 4, 4, 4, 4},       {17, 17, 17, 17, 17, 17, 14},
	{17, 17, 17, 17, 17, 10, 4},  {17, 17, 17, 21, 21, 21, 10}, {17, 17, 10, 4, 10, 17, 17},
	{17, 17, 17, 10, 4, 4, 4},    {31, 1, 2, 4, 8, 16, 31},     {14, 8, 8, 8, 8, 8, 14},
	{0, 16, 8, 4, 2, 1, 0},       {14, 2, 2, 2, 2, 2, 14},      {4, 10, 17, 0, 0, 0, 0},
	{0, 0, 0, 0, 0, 0, 31},
};

void overlay_begin(struct overlay *overlay, uint32_t width, uint32_t height)
{
	overlay->count = 0;
	overlay->failed = false;
	overlay->width = width;
	overlay->height = height;
	overlay->unit = fmax(1.0, floor(fmin(width / 320.0, height / 180.0) * 0.5 + 0.5));
}

void overlay_finish(struct overlay *overlay)
{
	free(overlay->vertices);
	*overlay = (struct overlay){0};
}

static bool reserve(struct overlay *overlay, size_t extra)
{
	if (overlay->failed)
		return false;
	if (overlay->count + extra <= overlay->capacity)
		return true;
	size_t wanted = overlay->capacity ? overlay->capacity * 2 : 4096;
	void *bigger = realloc(overlay->vertices, wanted * sizeof(*overlay->vertices));
	if (!bigger) {
		overlay->failed = true;
		return false;
	}
	overlay->vertices = bigger;
	overlay->capacity = wanted;
	return true;
}

static void add_quad(struct overlay *overlay, const float corners[4][2], const float uv[4][2], uint32_t color,
					 double alpha)
{
	if (!reserve(overlay, 6))
		return;
	static const int order[6] = {0, 1, 2, 0, 2, 3};
	for (int i = 0; i < 6; i++) {
		struct overlay_vertex *v = &overlay->vertices[overlay->count++];
		memcpy(v->position, corners[order[i]], sizeof(v->position));
		memcpy(v->uv, uv[order[i]], sizeof(v->uv));
		for (int c = 0; c < 3; c++)
			v->color[c] = (uint8_t)lrint((double)((color >> (16 - 8 * c)) & 255u) * alpha);
		v->color[3] = (uint8_t)lrint(255.0 * alpha);
	}
}

static const float solid[4][2] = {
	{0.5f / OVERLAY_ATLAS_WIDTH, 0.5f / OVERLAY_ATLAS_HEIGHT},
	{0.5f / OVERLAY_ATLAS_WIDTH, 0.5f / OVERLAY_ATLAS_HEIGHT},
	{0.5f / OVERLAY_ATLAS_WIDTH, 0.5f / OVERLAY_ATLAS_HEIGHT},
	{0.5f / OVERLAY_ATLAS_WIDTH, 0.5f / OVERLAY_ATLAS_HEIGHT},
};

void overlay_rectangle(struct overlay *overlay, double x, double y, double width, double height, uint32_t color,
					   double alpha)
{
	float x0 = (float)floor(x + 0.5), y0 = (float)floor(y + 0.5);
	float x1 = (float)floor(x + width + 0.5), y1 = (float)floor(y + height + 0.5);
	const float corners[4][2] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
	if (x1 > x0 && y1 > y0)
		add_quad(overlay, corners, solid, color, alpha);
}

void overlay_frame(struct overlay *overlay, double x, double y, double width, double height, double line,
				   uint32_t color, double alpha)
{
	overlay_rectangle(overlay, x, y, width, line, color, alpha);
	overlay_rectangle(overlay, x, y + height - line, width, line, color, alpha);
	overlay_rectangle(overlay, x, y + line, line, height - 2.0 * line, color, alpha);
	overlay_rectangle(overlay, x + width - line, y + line, line, height - 2.0 * line, color, alpha);
}

void overlay_line(struct overlay *overlay, double x0, double y0, double x1, double y1, double thickness, uint32_t color,
				  double alpha)
{
	double dx = x1 - x0, dy = y1 - y0, length = hypot(dx, dy);
	if (length <= 0.0)
		return;
	double nx = -dy / length * thickness * 0.5, ny = dx / length * thickness * 0.5;
	const float corners[4][2] = {{(float)(x0 + nx), (float)(y0 + ny)},
								 {(float)(x1 + nx), (float)(y1 + ny)},
								 {(float)(x1 - nx), (float)(y1 - ny)},
								 {(float)(x0 - nx), (float)(y0 - ny)}};
	add_quad(overlay, corners, solid, color, alpha);
}

double overlay_text(struct overlay *overlay, double x, double y, double scale, uint32_t color, const char *text)
{
	float pixel = (float)fmax(1.0, floor(overlay->unit * scale + 0.5));
	float left = (float)floor(x + 0.5), top = (float)floor(y + 0.5), pen = left;
	for (; *text; text++) {
		int c = *text >= 'a' && *text <= 'z' ? *text - 'a' + 'A' : *text;
		if (c > FIRST && c <= LAST) {
			int cell = c - FIRST;
			float u = (float)(cell % COLUMNS * CELL + 1), v = (float)(cell / COLUMNS * CELL + 1);
			float u0 = u / OVERLAY_ATLAS_WIDTH, u1 = (u + GLYPH_WIDTH) / OVERLAY_ATLAS_WIDTH;
			float v0 = v / OVERLAY_ATLAS_HEIGHT, v1 = (v + GLYPH_HEIGHT) / OVERLAY_ATLAS_HEIGHT;
			float right = pen + GLYPH_WIDTH * pixel, bottom = top + GLYPH_HEIGHT * pixel;
			const float corners[4][2] = {{pen, top}, {right, top}, {right, bottom}, {pen, bottom}};
			const float uv[4][2] = {{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}};
			add_quad(overlay, corners, uv, color, 1.0);
		}
		pen += (GLYPH_WIDTH + 1) * pixel;
	}
	return (double)(pen - left);
}

void overlay_fill_atlas(uint8_t *pixels)
{
	memset(pixels, 0, OVERLAY_ATLAS_WIDTH * OVERLAY_ATLAS_HEIGHT);
	for (int cell = 0; cell <= LAST - FIRST; cell++) {
		uint8_t *corner = pixels + (cell / COLUMNS * CELL + 1) * OVERLAY_ATLAS_WIDTH + cell % COLUMNS * CELL + 1;
		for (int y = 0; y < GLYPH_HEIGHT; y++) {
			for (int x = 0; x < GLYPH_WIDTH; x++)
				corner[y * OVERLAY_ATLAS_WIDTH + x] = (font[cell][y] >> (GLYPH_WIDTH - 1 - x)) & 1 ? 255 : 0;
		}
	}
	pixels[0] = 255;
}

uint64_t overlay_hash(const struct overlay *overlay)
{
	const uint8_t *bytes = (const uint8_t *)overlay->vertices;
	size_t size = overlay->count * sizeof(*overlay->vertices);
	uint64_t hash = 1469598103934665603u ^ size;
	for (size_t i = 0; i + 4 <= size; i += 4) {
		uint32_t word;
		memcpy(&word, bytes + i, 4);
		hash = (hash ^ word) * 1099511628211u;
	}
	return hash;
}
