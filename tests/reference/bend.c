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

/* The motion, over the interval now, of what the frame before shows at a place; false outside it. */
static bool look_up(const struct reference_geometry *before, double x, double y, double ratio,
					const struct reference_vertex *vertex, struct vector *found, bool *open)
{
	const bool near_border = fmin(fmin(x, y), fmin(before->width - x, before->height - y)) < OPEN;
	*open |= near_border && fmax(fmax(-x, -y), fmax(x - before->width, y - before->height)) < OPEN;
	if (x < 0.0 || y < 0.0 || x >= before->width || y >= before->height)
		return false;
	const double i = floor(fmin(fmax(x - 0.5, 0.0), before->width - 1.0));
	const double j = floor(fmin(fmax(y - 0.5, 0.0), before->height - 1.0));
	const double apart = unlike(before, i, j);
	/* A place on a row or column of centres may be seen with the pixels on either side of it. */
	if (fabs(x - 0.5 - round(x - 0.5)) < OPEN || fabs(y - 0.5 - round(y - 0.5)) < OPEN)
		for (int k = 0; k < 9; k++)
			*open |= (unlike(before, i + k % 3 - 1, j + k / 3 - 1) > 1.0) != (apart > 1.0);
	*open |= fabs(apart - 1.0) < OPEN;
	const struct vector v = apart <= 1.0 ? bilinear(before, x, y) : alike(before, x, y, ratio, vertex, open);
	*found = (struct vector){ratio * v.x, ratio * v.y};
	return true;
}

static void bend_vertex(struct reference_vertex *vertex, const struct reference_geometry *before,
						const struct reference_times *times)
{
	const double gap = times->gap_s / times->real_s, span = times->span_s / times->real_s;
	const double weight = times->real_s / (times->gap_s + (times->span_before_s - times->span_s) / 2.0);
	const double ratio = times->real_s / times->real_before_s;
	struct vector change = {0.0, 0.0}, v;
	bool open = false;
	if (vertex->ux == 0.0 && vertex->uy == 0.0)
		return;
	for (int look = 0; look < (times->gap_s == times->span_s ? 1 : 2); look++) {
		const double off = gap * (gap - span) / 2.0 * weight;
		const double x = vertex->x - gap * vertex->ux + off * change.x;
		const double y = vertex->y - gap * vertex->uy + off * change.y;
		if (!look_up(before, x, y, ratio, vertex, &v, &open)) {
			vertex->either |= open;
			return;
		}
		change = (struct vector){vertex->ux - v.x, vertex->uy - v.y};
	}
	const double length = hypot(vertex->ux, vertex->uy), changed = hypot(change.x, change.y) * fmax(1.0, weight);
	vertex->either |= open || fabs(changed - length / 2.0) < OPEN;
	vertex->ax = changed <= length / 2.0 ? weight * change.x : 0.0;
	vertex->ay = changed <= length / 2.0 ? weight * change.y : 0.0;
}

void reference_grid_bend(struct reference_grid *grid, const struct reference_geometry *now,
						 const struct reference_geometry *before, const struct reference_times *times)
{
	if (!now->known || !before->known || now->width != before->width || now->height != before->height)
		return;
	grid->span = times->span_s / times->real_s;
	for (uint32_t i = 0; i < grid->columns * grid->rows; i++)
		bend_vertex(&grid->vertices[i], before, times);
}
