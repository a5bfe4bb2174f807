/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The quadratic motion model (docs/method.md, 10). */
#include "reference.h"

#include <math.h>

/* How near to a boundary of a decision float and double may part. */
#define OPEN 1e-4

struct vector {
	double x, y;
};

static struct vector motion(const struct reference_geometry *geometry, double i, double j)
{
	const double x = fmin(fmax(i, 0.0), geometry->width - 1.0), y = fmin(fmax(j, 0.0), geometry->height - 1.0);
	const size_t at = (size_t)y * geometry->width + (size_t)x;
	return (struct vector){geometry->ux[at], geometry->uy[at]};
}

/* The largest difference of a component among the four pixels around a place. */
static double unlike(const struct reference_geometry *geometry, double i, double j)
{
	double most = 0.0;
	for (int k = 0; k < 4; k++)
		for (int l = 0; l < 4; l++) {
			const struct vector a = motion(geometry, i + (k & 1), j + (k >> 1));
			const struct vector b = motion(geometry, i + (l & 1), j + (l >> 1));
			most = fmax(most, fmax(fabs(a.x - b.x), fabs(a.y - b.y)));
		}
	return most;
}

static struct vector bilinear(const struct reference_geometry *geometry, double x, double y)
{
	const double i = floor(x - 0.5), j = floor(y - 0.5), s = x - 0.5 - i, t = y - 0.5 - j;
	const struct vector a = motion(geometry, i, j), b = motion(geometry, i + 1.0, j);
	const struct vector c = motion(geometry, i, j + 1.0), d = motion(geometry, i + 1.0, j + 1.0);
	return (struct vector){(1.0 - s) * (1.0 - t) * a.x + s * (1.0 - t) * b.x + (1.0 - s) * t * c.x + s * t * d.x,
						   (1.0 - s) * (1.0 - t) * a.y + s * (1.0 - t) * b.y + (1.0 - s) * t * c.y + s * t * d.y};
}

/* The most alike of 3 x 3; *open if another one is as good. */
static struct vector alike(const struct reference_geometry *before, double x, double y, double ratio,
						   const struct reference_vertex *vertex, bool *open)
{
	double least = HUGE_VAL;
	struct vector best = {0.0, 0.0};
	for (int k = 0; k < 9; k++) {
		const double i = floor(x) + k % 3 - 1, j = floor(y) + k / 3 - 1;
		if (i < 0.0 || j < 0.0 || i >= before->width || j >= before->height)
			continue;
		const struct vector v = motion(before, i, j);
		const double off = hypot(vertex->ux - ratio * v.x, vertex->uy - ratio * v.y);
		if (off < least) {
			*open |= least - off < OPEN && (fabs(v.x - best.x) > 1e-9 || fabs(v.y - best.y) > 1e-9);
			least = off;
			best = v;
		} else {
			*open |= off - least < OPEN && (fabs(v.x - best.x) > 1e-9 || fabs(v.y - best.y) > 1e-9);
		}
	}
	*open |= fabs(x - round(x)) < OPEN || fabs(y - round(y)) < OPEN;
	return best;
}

static void bend_vertex(struct reference_vertex *vertex, const struct reference_geometry *before, double ratio)
{
	const double x = vertex->x - vertex->ux, y = vertex->y - vertex->uy;
	const bool near_border = fmin(fmin(x, y), fmin(before->width - x, before->height - y)) < OPEN;
	bool open = near_border && fmax(fmax(-x, -y), fmax(x - before->width, y - before->height)) < OPEN;
	if ((vertex->ux == 0.0 && vertex->uy == 0.0) || x < 0.0 || y < 0.0 || x >= before->width || y >= before->height) {
		vertex->either |= open;
		return;
	}
	const double i = floor(fmin(fmax(x - 0.5, 0.0), before->width - 1.0));
	const double j = floor(fmin(fmax(y - 0.5, 0.0), before->height - 1.0));
	const double apart = unlike(before, i, j);
	/* A place on a row or column of centres may be seen with the pixels on either side of it. */
	if (fabs(x - 0.5 - round(x - 0.5)) < OPEN || fabs(y - 0.5 - round(y - 0.5)) < OPEN)
		for (int k = 0; k < 9; k++)
			open |= (unlike(before, i + k % 3 - 1, j + k / 3 - 1) > 1.0) != (apart > 1.0);
	open |= fabs(apart - 1.0) < OPEN;
	const struct vector v = apart <= 1.0 ? bilinear(before, x, y) : alike(before, x, y, ratio, vertex, &open);
	const double weight = 2.0 * ratio / (ratio + 1.0);
	const double ax = weight * (vertex->ux - ratio * v.x), ay = weight * (vertex->uy - ratio * v.y);
	const double length = hypot(vertex->ux, vertex->uy), change = hypot(ax, ay);
	vertex->either |= open || fabs(change - length / 2.0) < OPEN;
	vertex->ax = change <= length / 2.0 ? ax : 0.0;
	vertex->ay = change <= length / 2.0 ? ay : 0.0;
}

void reference_grid_bend(struct reference_grid *grid, const struct reference_geometry *now,
						 const struct reference_geometry *before, double ratio)
{
	if (!now->known || !before->known || now->width != before->width || now->height != before->height)
		return;
	for (uint32_t i = 0; i < grid->columns * grid->rows; i++)
		bend_vertex(&grid->vertices[i], before, ratio);
}
