/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The warp as a plain rasteriser, and the distortion of triangles (docs/method.md, 3). */
#include "reference.h"

#include <math.h>

void reference_singular(const struct reference_grid *grid, const uint32_t v[3], double phase, double sigma[2])
{
	double sx[3], sy[3], dx[3], dy[3];
	reference_displaced(grid, v, 0.0, sx, sy);
	reference_displaced(grid, v, phase, dx, dy);
	/* A with A (s1 - s0) = d1 - d0, A (s2 - s0) = d2 - d0. */
	const double ax = sx[1] - sx[0], ay = sy[1] - sy[0], bx = sx[2] - sx[0], by = sy[2] - sy[0];
	const double cx = dx[1] - dx[0], cy = dy[1] - dy[0], ex = dx[2] - dx[0], ey = dy[2] - dy[0];
	const double det = ax * by - bx * ay;
	const double a11 = (cx * by - ex * ay) / det, a12 = (ex * ax - cx * bx) / det;
	const double a21 = (cy * by - ey * ay) / det, a22 = (ey * ax - cy * bx) / det;
	/* Closed form for 2 x 2: sigma = sqrt(P) +- sqrt(Q) with sums and differences along and across the diagonal. */
	const double along = hypot(a11 + a22, a21 - a12) / 2.0, across = hypot(a11 - a22, a21 + a12) / 2.0;
	sigma[0] = along + across;
	sigma[1] = fabs(along - across);
}

/*
 * Signed distance (times the edge's length) of p from the edge a -> b. Always
 * computed from the vertex with the smaller index, so that two triangles that
 * share an edge get numbers that differ in sign and in nothing else: there is
 * no gap between them, whatever the rounding.
 */
static double edge(uint32_t ia, uint32_t ib, double ax, double ay, double bx, double by, double px, double py)
{
	if (ia > ib)
		return -edge(ib, ia, bx, by, ax, ay, px, py);
	return (bx - ax) * (py - ay) - (by - ay) * (px - ax);
}

struct box {
	long x0, y0, x1, y1; /* pixels, end inclusive */
};

static struct box box_of(const double x[3], const double y[3], uint32_t width, uint32_t height)
{
	struct box box;
	box.x0 = (long)fmax(0.0, floor(fmin(x[0], fmin(x[1], x[2])) - 0.5));
	box.y0 = (long)fmax(0.0, floor(fmin(y[0], fmin(y[1], y[2])) - 0.5));
	box.x1 = (long)fmin(width - 1.0, ceil(fmax(x[0], fmax(x[1], x[2])) - 0.5));
	box.y1 = (long)fmin(height - 1.0, ceil(fmax(y[0], fmax(y[1], y[2])) - 0.5));
	return box;
}

static void draw(const struct reference_grid *grid, uint32_t index, uint32_t width, uint32_t height, double phase,
				 struct reference_hit *hits)
{
	const uint32_t *v = grid->triangles[index].v;
	const struct reference_vertex *a = &grid->vertices[v[0]], *b = &grid->vertices[v[1]], *c = &grid->vertices[v[2]];
	double x[3], y[3];
	if (!(reference_area2(grid, v, phase) > 0.0))
		return;
	reference_displaced(grid, v, phase, x, y);
	const struct box box = box_of(x, y, width, height);
	for (long j = box.y0; j <= box.y1; j++)
		for (long i = box.x0; i <= box.x1; i++) {
			const double px = (double)i + 0.5, py = (double)j + 0.5;
			const double ea = edge(v[1], v[2], x[1], y[1], x[2], y[2], px, py);
			const double eb = edge(v[2], v[0], x[2], y[2], x[0], y[0], px, py);
			const double ec = edge(v[0], v[1], x[0], y[0], x[1], y[1], px, py);
			const double sum = ea + eb + ec;
			if (ea < 0.0 || eb < 0.0 || ec < 0.0 || !(sum > 0.0))
				continue;
			const double z = (ea * a->z + eb * b->z + ec * c->z) / sum;
			struct reference_hit *hit = &hits[j * (long)width + i];
			if (hit->triangle >= 0 && !(z < hit->z))
				continue;
			hit->triangle = (int32_t)index;
			hit->z = z;
			hit->x = (ea * a->x + eb * b->x + ec * c->x) / sum;
			hit->y = (ea * a->y + eb * b->y + ec * c->y) / sum;
		}
}

void reference_warp(const struct reference_grid *grid, uint32_t width, uint32_t height, double phase,
					struct reference_hit *hits)
{
	for (size_t i = 0; i < (size_t)width * height; i++)
		hits[i] = (struct reference_hit){.triangle = -1};
	for (uint32_t t = 0; t < grid->triangle_count; t++)
		draw(grid, t, width, height, phase, hits);
}
