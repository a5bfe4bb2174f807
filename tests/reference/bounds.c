/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The planes L, B, E at their least and most, and the triangles that may be drawn. */
#include "bounds.h"

#include <math.h>
#include <stdlib.h>

static bool undecided(const struct reference_grid *grid, const uint32_t v[3])
{
	return grid->vertices[v[0]].either || grid->vertices[v[1]].either || grid->vertices[v[2]].either;
}

static void add(struct bounds *bounds, uint32_t a, uint32_t b, uint32_t c, bool certain)
{
	struct bounds_triangle *triangle = &bounds->triangles[bounds->triangle_count++];
	*triangle = (struct bounds_triangle){.v = {a, b, c}};
	triangle->excused = undecided(&bounds->reference->grid, triangle->v);
	triangle->certain = certain && !triangle->excused;
}

/* Both ways to split quads that may be split either way. */
static void add_triangles(struct bounds *bounds)
{
	const struct reference_grid *grid = &bounds->reference->grid;
	bounds->triangles = reference_alloc(2 * (size_t)grid->triangle_count, sizeof(*bounds->triangles));
	for (uint32_t t = 0; t < grid->triangle_count; t += 2) {
		const uint32_t row = t / 2 / (grid->columns - 1), column = t / 2 % (grid->columns - 1);
		const uint32_t v00 = row * grid->columns + column, v01 = v00 + grid->columns;
		const bool either = grid->triangles[t].either;
		const bool falls = grid->triangles[t].v[2] == v01 + 1;
		if (falls || either) {
			add(bounds, v00, v00 + 1, v01 + 1, !either);
			add(bounds, v00, v01 + 1, v01, !either);
		}
		if (!falls || either) {
			add(bounds, v00, v00 + 1, v01, !either);
			add(bounds, v00 + 1, v01 + 1, v01, !either);
		}
	}
}

/* Least and most w of a triangle. */
static void weight_range(const struct bounds *bounds, const struct bounds_triangle *triangle, double w[2])
{
	const struct reference *reference = bounds->reference;
	const double phase = reference->timing.last_phase;
	double sigma[2];
	if (reference->blur_hold) {
		w[0] = w[1] = reference->blur == ENGINE_BLUR_OFF ? 0.0 : 1.0;
		return;
	}
	w[0] = w[1] =
		reference->geometry.moves ? reference_weight(&reference->grid, triangle->v, phase, reference->blur) : 0.0;
	if (reference->blur != ENGINE_BLUR_DOUBTFUL)
		return;
	if (triangle->excused) {
		w[0] = 0.0;
		w[1] = 1.0;
		return;
	}
	reference_singular(&reference->grid, triangle->v, phase, sigma);
	const double area = reference_area2(&reference->grid, triangle->v, phase);
	const double slack = BOUNDS_STRETCH * sigma[0];
	const bool may_turn = fabs(area) < BOUNDS_STRETCH * (1.0 + sigma[0]);
	if (area > 0.0 || may_turn) {
		w[0] = reference_weight_of(sigma[0] - slack);
		w[1] = reference_weight_of(sigma[0] + slack);
	}
	if (may_turn)
		w[0] = 0.0;
}

/* Is a pixel centre in the closed source triangle? */
static bool touches(const struct reference_grid *grid, const uint32_t v[3], double px, double py)
{
	for (int k = 0; k < 3; k++) {
		const struct reference_vertex *a = &grid->vertices[v[k]], *b = &grid->vertices[v[(k + 1) % 3]];
		const double dx = b->x - a->x, dy = b->y - a->y;
		if ((dx * (py - a->y) - dy * (px - a->x)) / hypot(dx, dy) < -BOUNDS_SUBPIXEL)
			return false;
	}
	return true;
}

static void spread_weight(const struct bounds *bounds, const struct bounds_triangle *triangle, double *least,
						  double *most)
{
	const struct reference *reference = bounds->reference;
	const struct reference_vertex *vertices = reference->grid.vertices;
	const uint32_t *v = triangle->v;
	const struct reference_vertex *a = &vertices[v[0]], *b = &vertices[v[1]], *c = &vertices[v[2]];
	const long width = (long)reference->width, height = (long)reference->height;
	const long x0 = (long)fmin(a->x, fmin(b->x, c->x)) - 1, x1 = (long)fmax(a->x, fmax(b->x, c->x)) + 1;
	const long y0 = (long)fmin(a->y, fmin(b->y, c->y)) - 1, y1 = (long)fmax(a->y, fmax(b->y, c->y)) + 1;
	double w[2];
	weight_range(bounds, triangle, w);
	for (long j = y0 < 0 ? 0 : y0; j <= y1 && j < height; j++)
		for (long i = x0 < 0 ? 0 : x0; i <= x1 && i < width; i++)
			if (touches(&reference->grid, v, (double)i + 0.5, (double)j + 0.5)) {
				least[j * width + i] = fmin(least[j * width + i], w[0]);
				most[j * width + i] = fmax(most[j * width + i], w[1]);
			}
}

/* A code value moved by what float loses beside a brighter o, and by rounding. */
static uint8_t push(const struct reference_compensation *how, double code, double o, double sign)
{
	const double light = reference_to_light(&how->display, code) + sign * 3e-7 * o;
	const double moved = light > 0.0 ? reference_from_light(&how->display, light) : 0.0;
	return reference_code8(sign < 0.0 ? fmin(moved, code) : fmax(moved, code), sign * BOUNDS_ROUNDING);
}

/* B and E are monotone in L and, the mix being linear, in w: their extremes lie at the corners. */
static void channel_range(struct bounds *bounds, size_t at, double least_w, double most_w)
{
	const struct reference_compensation *how = &bounds->reference->compensation;
	const uint8_t original = bounds->reference->original.data[at];
	const double c = original / 255.0, o = reference_to_light(&how->display, c);
	const uint8_t low[2] = {bounds->low[0].data[at], bounds->low[1].data[at]};
	double b[2] = {2.0, -1.0}, e[2] = {2.0, -1.0};
	for (int k = 0; k < 4; k++) {
		double between, real;
		if ((k & 1 && low[0] == low[1]) || (k >> 1 && least_w == most_w))
			continue;
		reference_compensate(how, c, low[k & 1] / 255.0, k >> 1 ? most_w : least_w, &between, &real);
		b[0] = fmin(b[0], between);
		b[1] = fmax(b[1], between);
		e[0] = fmin(e[0], real);
		e[1] = fmax(e[1], real);
	}
	for (int side = 0; side < 2; side++) {
		bounds->between[side].data[at] = push(how, b[side], o, side ? 1.0 : -1.0);
		bounds->real[side].data[at] = push(how, e[side], o, side ? 1.0 : -1.0);
	}
}

/* Where w is 0 for sure, B and E are the original, exactly. */
static void pixel_range(struct bounds *bounds, size_t pixel, double least_w, double most_w)
{
	for (size_t at = pixel * 4; at < pixel * 4 + 3; at++) {
		const uint8_t original = bounds->reference->original.data[at];
		for (int side = 0; side < 2; side++)
			bounds->between[side].data[at] = bounds->real[side].data[at] = original;
		if (most_w > 0.0)
			channel_range(bounds, at, least_w, most_w);
	}
}

void bounds_init(struct bounds *bounds, const struct reference *reference)
{
	const size_t count = (size_t)reference->width * reference->height;
	double *least = reference_alloc(count, sizeof(double)), *most = reference_alloc(count, sizeof(double));
	*bounds = (struct bounds){.reference = reference};
	add_triangles(bounds);
	for (int side = 0; side < 2; side++) {
		reference_low(&bounds->low[side], &reference->original, reference->blur_level,
					  side ? BOUNDS_ROUNDING : -BOUNDS_ROUNDING);
		reference_picture_init(&bounds->between[side], reference->width, reference->height);
		reference_picture_init(&bounds->real[side], reference->width, reference->height);
	}
	for (size_t i = 0; i < count; i++) {
		least[i] = 1.0;
		most[i] = 0.0;
	}
	for (uint32_t t = 0; t < bounds->triangle_count; t++)
		spread_weight(bounds, &bounds->triangles[t], least, most);
	for (size_t i = 0; i < count; i++)
		pixel_range(bounds, i, least[i], most[i]);
	free(least);
	free(most);
}

void bounds_finish(struct bounds *bounds)
{
	free(bounds->triangles);
	for (int side = 0; side < 2; side++) {
		reference_picture_finish(&bounds->low[side]);
		reference_picture_finish(&bounds->between[side]);
		reference_picture_finish(&bounds->real[side]);
	}
	*bounds = (struct bounds){0};
}
