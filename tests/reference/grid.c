/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The snapped grid and its triangles (docs/method.md, 2; Didyk et al. 2010, Sections 5.1, 6, Figures 4 and 6). */
#include "reference.h"

#include <math.h>
#include <stdlib.h>

static size_t at(const struct reference_geometry *geometry, uint32_t i, uint32_t j)
{
	return (size_t)j * geometry->width + i;
}

static double difference(const struct reference_geometry *geometry, size_t a, size_t b)
{
	const double dx = geometry->ux[a] - geometry->ux[b], dy = geometry->uy[a] - geometry->uy[b];
	return sqrt(dx * dx + dy * dy);
}

uint32_t reference_discontinuity(const struct reference_geometry *geometry, uint32_t i, uint32_t j, double *gx,
								 double *gy)
{
	const size_t here = at(geometry, i, j);
	const double x = i + 1 < geometry->width ? difference(geometry, here, at(geometry, i + 1, j)) : 0.0;
	const double y = j + 1 < geometry->height ? difference(geometry, here, at(geometry, i, j + 1)) : 0.0;
	const double q = floor(4.0 * (x > y ? x : y));
	if (gx)
		*gx = x;
	if (gy)
		*gy = y;
	return q > 63.0 ? 63 : (uint32_t)q;
}

/* Does u at two neighbours survive being a float without change? Then differences of both precisions agree. */
static bool exact(const struct reference_geometry *geometry, size_t a, size_t b)
{
	return (double)(float)geometry->ux[a] == geometry->ux[a] && (double)(float)geometry->uy[a] == geometry->uy[a] &&
		   (double)(float)geometry->ux[b] == geometry->ux[b] && (double)(float)geometry->uy[b] == geometry->uy[b];
}

/* Rounding of a difference of two displacements in float: each has 2^-24, and a few operations follow. */
static double rounding(const struct reference_geometry *geometry, size_t a, size_t b)
{
	const double size = fabs(geometry->ux[a]) + fabs(geometry->uy[a]) + fabs(geometry->ux[b]) + fabs(geometry->uy[b]);
	return 4e-7 * (size + difference(geometry, a, b));
}

/* Is q of this pixel, or the choice between gx and gy, one that float may take differently? */
static bool pixel_either(const struct reference_geometry *geometry, uint32_t i, uint32_t j)
{
	const size_t here = at(geometry, i, j);
	const size_t right = i + 1 < geometry->width ? at(geometry, i + 1, j) : here;
	const size_t below = j + 1 < geometry->height ? at(geometry, i, j + 1) : here;
	double gx, gy;
	reference_discontinuity(geometry, i, j, &gx, &gy);
	const double g = gx > gy ? gx : gy;
	const double slack = rounding(geometry, here, right) + rounding(geometry, here, below);
	const double off = fabs(4.0 * g - round(4.0 * g));
	const bool is_exact = exact(geometry, here, right) && exact(geometry, here, below);
	if (round(4.0 * g) >= 1.0 && round(4.0 * g) <= 63.0 && off <= 4.0 * slack && !(off == 0.0 && is_exact))
		return true;
	return fabs(gx - gy) <= slack && !(gx == gy && is_exact);
}

struct cell {
	uint32_t x0, y0, x1, y1; /* extent, end exclusive */
	double cx, cy;
};

static double from_centre(const struct cell *cell, uint32_t i, uint32_t j)
{
	const double dx = i + 0.5 - cell->cx, dy = j + 0.5 - cell->cy;
	return dx * dx + dy * dy;
}

/* The pixel that a cell snaps to; its q. */
static uint32_t strongest(const struct reference_geometry *geometry, const struct cell *cell, uint32_t *i, uint32_t *j)
{
	uint32_t best = 0;
	*i = cell->x0;
	*j = cell->y0;
	for (uint32_t y = cell->y0; y < cell->y1; y++)
		for (uint32_t x = cell->x0; x < cell->x1; x++) {
			const uint32_t q = reference_discontinuity(geometry, x, y, NULL, NULL);
			const bool first = x == cell->x0 && y == cell->y0;
			if (first || q > best || (q == best && from_centre(cell, x, y) < from_centre(cell, *i, *j))) {
				best = q;
				*i = x;
				*j = y;
			}
		}
	return best;
}

/* May float choose another pixel of the cell, or snap where double does not? */
static bool cell_either(const struct reference_geometry *geometry, const struct cell *cell, uint32_t best,
						uint32_t threshold)
{
	for (uint32_t y = cell->y0; y < cell->y1; y++)
		for (uint32_t x = cell->x0; x < cell->x1; x++) {
			const uint32_t q = reference_discontinuity(geometry, x, y, NULL, NULL);
			if (q + 1 >= best && q + 1 >= threshold && pixel_either(geometry, x, y))
				return true;
		}
	return false;
}

static double square(const struct reference_geometry *geometry, size_t pixel)
{
	return geometry->ux[pixel] * geometry->ux[pixel] + geometry->uy[pixel] * geometry->uy[pixel];
}

static void take(struct reference_vertex *vertex, const struct reference_geometry *geometry, size_t pixel)
{
	vertex->ux = geometry->ux[pixel];
	vertex->uy = geometry->uy[pixel];
	vertex->z = geometry->z[pixel];
}

static void snap(struct reference_vertex *vertex, const struct reference_geometry *geometry, uint32_t i, uint32_t j)
{
	double gx, gy;
	reference_discontinuity(geometry, i, j, &gx, &gy);
	const bool across = gx >= gy;
	const size_t here = at(geometry, i, j), other = across ? at(geometry, i + 1, j) : at(geometry, i, j + 1);
	const double zh = geometry->z[here], zo = geometry->z[other];
	const double uh = square(geometry, here), uo = square(geometry, other);
	const bool other_nearer = zo < zh || (zo == zh && uo > uh);

	vertex->snapped = true;
	vertex->x = across ? i + 1.0 : i + 0.5;
	vertex->y = across ? j + 0.5 : j + 1.0;
	take(vertex, geometry, other_nearer ? other : here);
	if (fabs(zh - zo) <= 2e-6 && zh != zo)
		vertex->either = true;
	if (fabs(zh - zo) <= 2e-6 && fabs(uh - uo) <= 1e-6 * (uh + uo) && !(uh == uo && exact(geometry, here, other)))
		vertex->either = true;
}

/* The two (or one) pixels around a centre along one axis. */
static void around(double centre, uint32_t pixels[2])
{
	pixels[1] = (uint32_t)floor(centre);
	pixels[0] = centre == floor(centre) ? pixels[1] - 1 : pixels[1];
}

static void rest(struct reference_vertex *vertex, const struct reference_geometry *geometry, const struct cell *cell)
{
	uint32_t is[2], js[2];
	around(cell->cx, is);
	around(cell->cy, js);
	vertex->x = cell->cx;
	vertex->y = cell->cy;
	vertex->z = 1.0;
	for (int b = 0; b < 2; b++)
		for (int a = 0; a < 2; a++) {
			const size_t pixel = at(geometry, is[a], js[b]);
			vertex->ux += geometry->ux[pixel] / 4.0;
			vertex->uy += geometry->uy[pixel] / 4.0;
			vertex->z = fmin(vertex->z, geometry->z[pixel]);
		}
}

static struct cell cell_of(const struct reference_geometry *geometry, uint32_t column, uint32_t row, uint32_t size)
{
	struct cell cell = {.x0 = column * size, .y0 = row * size};
	cell.x1 = cell.x0 + size < geometry->width ? cell.x0 + size : geometry->width;
	cell.y1 = cell.y0 + size < geometry->height ? cell.y0 + size : geometry->height;
	cell.cx = (cell.x0 + cell.x1) / 2.0;
	cell.cy = (cell.y0 + cell.y1) / 2.0;
	return cell;
}

/* Where a column (or row) of vertices lies when it is not snapped. */
static double line_at(uint32_t index, uint32_t count, uint32_t size, uint32_t extent)
{
	if (index == 0)
		return 0.0;
	if (index == count - 1)
		return extent;
	const uint32_t from = (index - 1) * size, to = from + size < extent ? from + size : extent;
	return (from + to) / 2.0;
}

static void border(struct reference_vertex *vertex, const struct reference_geometry *geometry, double x, double y)
{
	const uint32_t i = x >= geometry->width ? geometry->width - 1 : (uint32_t)floor(x);
	const uint32_t j = y >= geometry->height ? geometry->height - 1 : (uint32_t)floor(y);
	vertex->x = x;
	vertex->y = y;
	vertex->z = geometry->z[at(geometry, i, j)];
}

static void place(struct reference_grid *grid, const struct reference_geometry *geometry, uint32_t column, uint32_t row,
				  uint32_t size, uint32_t threshold)
{
	struct reference_vertex *vertex = &grid->vertices[(size_t)row * grid->columns + column];
	if (column == 0 || row == 0 || column == grid->columns - 1 || row == grid->rows - 1) {
		border(vertex, geometry, line_at(column, grid->columns, size, geometry->width),
			   line_at(row, grid->rows, size, geometry->height));
		return;
	}
	const struct cell cell = cell_of(geometry, column - 1, row - 1, size);
	uint32_t i, j;
	const uint32_t q = strongest(geometry, &cell, &i, &j);
	if (q >= threshold)
		snap(vertex, geometry, i, j);
	else
		rest(vertex, geometry, &cell);
	vertex->either |= cell_either(geometry, &cell, q, threshold);
	grid->snapped += vertex->snapped;
}

void reference_displaced(const struct reference_grid *grid, const uint32_t v[3], double phase, double x[3], double y[3])
{
	const double bend = phase * (phase + grid->span) / 2.0;
	for (int k = 0; k < 3; k++) {
		x[k] = grid->vertices[v[k]].x + phase * grid->vertices[v[k]].ux + bend * grid->vertices[v[k]].ax;
		y[k] = grid->vertices[v[k]].y + phase * grid->vertices[v[k]].uy + bend * grid->vertices[v[k]].ay;
	}
}

double reference_area2(const struct reference_grid *grid, const uint32_t v[3], double phase)
{
	double x[3], y[3];
	reference_displaced(grid, v, phase, x, y);
	return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
}

static double apart(const struct reference_vertex *a, const struct reference_vertex *b)
{
	return (a->ux - b->ux) * (a->ux - b->ux) + (a->uy - b->uy) * (a->uy - b->uy);
}

static bool same(const struct reference_vertex *a, const struct reference_vertex *b)
{
	return a->ux == b->ux && a->uy == b->uy;
}

/* Is the order of two squared differences within what float may turn around? */
static bool apart_either(const struct reference_vertex *q[4])
{
	double size = 0.0;
	const double one = apart(q[0], q[3]), other = apart(q[1], q[2]);
	for (int k = 0; k < 4; k++)
		size += fabs(q[k]->ux) + fabs(q[k]->uy);
	if ((same(q[0], q[1]) && same(q[2], q[3])) || (same(q[0], q[2]) && same(q[1], q[3])))
		return false; /* equal operands in any precision */
	return fabs(one - other) <= 1e-6 * (sqrt(one) + sqrt(other)) * size + 1e-12;
}

static void split(struct reference_grid *grid, uint32_t v00, uint32_t v10, uint32_t v01, uint32_t v11)
{
	const struct reference_triangle falling[2] = {{{v00, v10, v11}, false}, {{v00, v11, v01}, false}};
	const struct reference_triangle rising[2] = {{{v00, v10, v01}, false}, {{v10, v11, v01}, false}};
	const bool can_fall =
		reference_area2(grid, falling[0].v, 0.0) > 0.0 && reference_area2(grid, falling[1].v, 0.0) > 0.0;
	const bool can_rise =
		reference_area2(grid, rising[0].v, 0.0) > 0.0 && reference_area2(grid, rising[1].v, 0.0) > 0.0;
	const struct reference_vertex *corners[4] = {&grid->vertices[v00], &grid->vertices[v10], &grid->vertices[v01],
												 &grid->vertices[v11]};
	const bool alike = apart(corners[0], corners[3]) <= apart(corners[1], corners[2]);
	const bool falls = can_fall != can_rise ? can_fall : alike;
	const bool either = can_fall == can_rise && apart_either(corners);
	for (int k = 0; k < 2; k++) {
		grid->triangles[grid->triangle_count] = falls ? falling[k] : rising[k];
		grid->triangles[grid->triangle_count++].either = either;
	}
}

void reference_grid_init(struct reference_grid *grid, const struct reference_geometry *geometry, uint32_t size,
						 uint32_t threshold)
{
	reference_grid_finish(grid);
	grid->columns = (geometry->width + size - 1) / size + 2;
	grid->rows = (geometry->height + size - 1) / size + 2;
	grid->vertices = reference_alloc((size_t)grid->columns * grid->rows, sizeof(*grid->vertices));
	grid->triangles = reference_alloc(2 * (size_t)(grid->columns - 1) * (grid->rows - 1), sizeof(*grid->triangles));
	for (uint32_t row = 0; row < grid->rows; row++)
		for (uint32_t column = 0; column < grid->columns; column++)
			place(grid, geometry, column, row, size, threshold);
	for (uint32_t row = 0; row + 1 < grid->rows; row++)
		for (uint32_t column = 0; column + 1 < grid->columns; column++) {
			const uint32_t v00 = row * grid->columns + column;
			split(grid, v00, v00 + 1, v00 + grid->columns, v00 + grid->columns + 1);
		}
}

void reference_grid_finish(struct reference_grid *grid)
{
	free(grid->vertices);
	free(grid->triangles);
	*grid = (struct reference_grid){0};
}
