/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/analysis/grid.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/analysis/facts.h"
#include "daemon/engine/analysis/kept.h"
#include "daemon/engine/analysis/values.h"

static float lesser(float a, float b)
{
	return a < b ? a : b;
}

/* i0 and i1 of an extent: the pixels that meet at its centre, or the one that holds it twice. */
static void middle(uint32_t start, uint32_t size, uint32_t *first, uint32_t *second)
{
	*second = start + size / 2;
	*first = size % 2 ? *second : *second - 1;
}

static uint32_t extent(uint32_t start, uint32_t cell, uint32_t end)
{
	return end - start < cell ? end - start : cell;
}

static void take_vertex_row(struct plan_vertex_row *row, size_t columns, struct plan_arena *arena)
{
	float **parts[] = {&row->x, &row->y, &row->ux, &row->uy, &row->z, &row->snapped};
	for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++)
		*parts[i] = plan_arena_take(arena, columns * sizeof(float));
}

static void fill_columns(struct plan_grid *grid, uint32_t cell)
{
	uint32_t width = grid->plan->width;
	for (uint32_t c = 0; c < grid->cells_x; c++) {
		uint32_t size = extent(c * cell, cell, width);
		middle(c * cell, size, &grid->first[c], &grid->second[c]);
		grid->centres[c] = (float)(c * cell) + 0.5f * (float)size;
	}
	for (uint32_t i = 0; i < width; i++)
		grid->z[i] = grid->z_second[i] = 0.5f;
}

void plan_grid_init(struct plan_grid *grid, const struct frame *frame, uint32_t cell, uint32_t threshold,
					struct plan_arena *arena)
{
	size_t width = grid->plan->width;
	grid->cells_x = (grid->plan->width + cell - 1) / cell;
	grid->cells_y = (grid->plan->height + cell - 1) / cell;
	grid->least = (float)(threshold * threshold) / 16.0f;
	size_t columns = grid->cells_x + 2;
	plan_rows_init(&grid->rows, frame, PURSUIT_ROLE_DEPTH, arena);
	if (frame->header.depth_kind == PURSUIT_DEPTH_NONE)
		grid->rows.data = NULL;
	grid->depth = plan_depth_of(&frame->header);
	grid->peaks = plan_arena_take(arena, width * sizeof(float));
	grid->largest = plan_arena_take(arena, columns * sizeof(float));
	grid->snaps = plan_arena_take(arena, columns * sizeof(uint32_t));
	grid->found = plan_arena_take(arena, columns * sizeof(uint32_t));
	grid->centres = plan_arena_take(arena, columns * sizeof(float));
	grid->first = plan_arena_take(arena, columns * sizeof(uint32_t));
	grid->second = plan_arena_take(arena, columns * sizeof(uint32_t));
	grid->z = plan_arena_take(arena, width * sizeof(float));
	grid->z_second = plan_arena_take(arena, width * sizeof(float));
	grid->diagonals = plan_arena_take(arena, columns * sizeof(uint32_t));
	take_vertex_row(&grid->ring[0], columns, arena);
	take_vertex_row(&grid->ring[1], columns, arena);
	grid->counts = (struct plan_grid_counts){0};
	if (arena->base)
		fill_columns(grid, cell);
}

/* Makes room for `count` of `size` bytes; what was there is lost. */
static int reserve(void **data, uint32_t *capacity, size_t count, size_t size)
{
	if (count <= *capacity)
		return 0;
	free(*data);
	*capacity = 0;
	*data = malloc(count * size);
	if (!*data)
		return -ENOMEM;
	*capacity = (uint32_t)count;
	return 0;
}

int plan_scratch_reserve(struct plan *plan, struct plan_arena *arena)
{
	if (arena->used > plan->scratch_bytes) {
		free(plan->scratch);
		plan->scratch_bytes = 0;
		plan->scratch = aligned_alloc(64, arena->used);
		if (!plan->scratch)
			return -ENOMEM;
		plan->scratch_bytes = arena->used;
	}
	*arena = (struct plan_arena){plan->scratch, 0};
	return 0;
}

int plan_grid_reserve(struct plan *plan)
{
	const uint32_t cell = plan->cell, columns = (plan->width + cell - 1) / cell + 2;
	const uint32_t rows = (plan->height + cell - 1) / cell + 2;
	void *vertices = plan->vertices, *indices = plan->indices;
	int failed = reserve(&vertices, &plan->vertex_capacity, (size_t)columns * rows, sizeof(*plan->vertices));
	plan->vertices = vertices;
	if (failed)
		return failed;
	failed = reserve(&indices, &plan->index_capacity, (size_t)(columns - 1) * (rows - 1) * 6, sizeof(*plan->indices));
	plan->indices = indices;
	if (failed)
		return failed;
	plan->columns = columns;
	plan->rows = rows;
	return 0;
}

static uint32_t *put_quad(uint32_t *index, uint32_t v00, uint32_t columns, uint32_t main)
{
	uint32_t v10 = v00 + 1, v01 = v00 + columns, v11 = v01 + 1;
	index[0] = v00;
	index[1] = v10;
	index[2] = v01 + main;
	index[3] = v10 - main;
	index[4] = v11;
	index[5] = v01;
	return index + 6;
}

/* A row of vertices that is in the plan already, into the ring. */
static void take_row(struct plan_grid *grid, uint32_t index)
{
	const struct plan *plan = grid->plan;
	const struct plan_vertex *vertex = plan->vertices + (size_t)index * plan->columns;
	struct plan_vertex_row *row = &grid->ring[index % 2];
	row->still = grid->absent[index % 2] = false;
	for (uint32_t i = 0; i < plan->columns; i++) {
		row->x[i] = vertex[i].x;
		row->y[i] = vertex[i].y;
		row->ux[i] = vertex[i].ux;
		row->uy[i] = vertex[i].uy;
	}
}

/* Triangles between the row in work and the one before. */
static void put_quads(struct plan_grid *grid)
{
	struct plan *plan = grid->plan;
	const struct plan_vertex_row *upper = &grid->ring[(grid->row + 1) % 2], *lower = &grid->ring[grid->row % 2];
	uint32_t columns = plan->columns, start = (grid->row - 1) * columns;
	uint32_t *index = plan->indices + 6 * (size_t)(columns - 1) * (grid->row - 1);
	if (upper->still && lower->still) {
		for (uint32_t i = 0; i + 1 < columns; i++)
			index = put_quad(index, start + i, columns, 1);
		return;
	}
	for (uint32_t i = grid->row - 1; i <= grid->row; i++)
		if (grid->absent[i % 2]) {
			take_row(grid, i);
			grid->ring[i % 2].still = true;
		}
	struct plan_quad_counts counts = grid->kernels->quads(upper, lower, columns - 1, plan->last_phase, grid->diagonals);
	grid->counts.folded += counts.folded;
	grid->counts.doubtful += counts.doubtful;
	for (uint32_t i = 0; i + 1 < columns; i++)
		index = put_quad(index, start + i, columns, grid->diagonals[i]);
}

static void put_row(struct plan_grid *grid)
{
	struct plan *plan = grid->plan;
	const struct plan_vertex_row *row = &grid->ring[grid->row % 2];
	struct plan_vertex *vertex = plan->vertices + (size_t)grid->row * plan->columns;
	for (uint32_t i = 0; i < plan->columns; i++)
		vertex[i] = (struct plan_vertex){row->x[i], row->y[i], row->ux[i], row->uy[i], row->z[i], row->snapped[i]};
	if (!row->still) {
		float largest = sqrtf(grid->kernels->largest_square(row->ux, row->uy, plan->columns));
		struct plan_grid_counts *counts = &grid->counts;
		counts->max_displacement = largest > counts->max_displacement ? largest : counts->max_displacement;
	}
	plan_kept_put(plan, grid->row, row->still);
	if (grid->follows)
		put_quads(grid);
	grid->follows = true;
	grid->row++;
}

/* Is the row in work in the plan, from a frame before? Then so are the triangles between two such rows. */
static bool keep_row(struct plan_grid *grid)
{
	const uint32_t here = grid->row % 2;
	if (!plan_kept_still(grid->plan, grid->row))
		return false;
	grid->ring[here].still = grid->absent[here] = true;
	if (grid->follows && !grid->absent[1 - here])
		put_quads(grid);
	grid->follows = true;
	grid->row++;
	return true;
}

void plan_grid_join(struct plan_grid *grid, uint32_t r)
{
	grid->row = r + 1;
	take_row(grid, r);
	take_row(grid, r + 1);
	put_quads(grid);
}

/* Regular positions at height y, z from grid->z, nothing moves. The border's z from row `edge`. */
static struct plan_vertex_row *start_row(struct plan_grid *grid, float y, const float *edge)
{
	struct plan_vertex_row *row = &grid->ring[grid->row % 2];
	uint32_t last = grid->cells_x + 1, width = grid->plan->width;
	row->still = true;
	grid->absent[grid->row % 2] = false;
	memset(row->ux, 0, (last + 1) * sizeof(float));
	memset(row->uy, 0, (last + 1) * sizeof(float));
	memset(row->snapped, 0, (last + 1) * sizeof(float));
	for (uint32_t i = 0; i <= last; i++)
		row->y[i] = y;
	row->x[0] = 0;
	row->z[0] = edge[0];
	memcpy(row->x + 1, grid->centres, grid->cells_x * sizeof(float));
	for (uint32_t c = 0; c < grid->cells_x; c++)
		row->z[c + 1] = lesser(grid->z[grid->first[c]], grid->z[grid->second[c]]);
	row->x[last] = (float)width;
	row->z[last] = edge[width - 1];
	return row;
}

static void read_depth(struct plan_grid *grid, uint32_t y, float *z)
{
	if (grid->rows.data)
		grid->kernels->depth_row(plan_rows_get(&grid->rows, y), grid->plan->width, &grid->depth, z);
}

static void put_border(struct plan_grid *grid, uint32_t pixel_row, float y)
{
	if (keep_row(grid))
		return;
	read_depth(grid, pixel_row, grid->z);
	struct plan_vertex_row *row = start_row(grid, y, grid->z);
	for (uint32_t c = 0; c < grid->cells_x; c++)
		row->z[c + 1] = grid->z[grid->second[c]];
	put_row(grid);
}

void plan_grid_begin(struct plan_grid *grid, uint32_t r)
{
	grid->row = r ? r + 1 : 0;
	grid->follows = false;
	if (r == 0)
		put_border(grid, 0, 0);
}

/* z of pixel rows j0 and j1: the smaller into grid->z, j1 alone into grid->z_second. */
static void read_middle(struct plan_grid *grid, uint32_t j0, uint32_t j1)
{
	if (!grid->rows.data)
		return;
	read_depth(grid, j0, grid->z);
	if (j0 == j1) {
		memcpy(grid->z_second, grid->z, grid->plan->width * sizeof(float));
		return;
	}
	read_depth(grid, j1, grid->z_second);
	for (uint32_t i = 0; i < grid->plan->width; i++)
		grid->z[i] = lesser(grid->z[i], grid->z_second[i]);
}

/* Largest k with k / 4 <= g, at most 63: exact, since k² and 16 g² are. */
static uint32_t quantised(float square)
{
	if (16.0f * square >= 63.0f * 63.0f)
		return 63;
	uint32_t k = (uint32_t)(4.0f * sqrtf(square));
	while ((float)(k * k) > 16.0f * square)
		k--;
	while ((float)((k + 1) * (k + 1)) <= 16.0f * square)
		k++;
	return k;
}

static float pixel_depth(const struct plan_grid *grid, uint32_t x, uint32_t y)
{
	return grid->rows.data ? plan_depth_value(plan_rows_pixel(&grid->rows, x, y), &grid->depth) : 0.5f;
}

struct side {
	float ux, uy, z;
};

static bool nearer(const struct side *a, const struct side *b)
{
	if (a->z != b->z)
		return a->z < b->z;
	return a->ux * a->ux + a->uy * a->uy > b->ux * b->ux + b->uy * b->uy;
}

/* Cell row in work. */
struct band {
	uint32_t start, size; /* rows of pixels */
	uint32_t j0, j1;      /* its middle ones */
	struct plan_field u;
};

static struct band band_of(const struct plan_grid *grid, uint32_t r)
{
	uint32_t cell = grid->plan->cell;
	struct band band = {.start = r * cell, .size = extent(r * cell, cell, grid->plan->height)};
	middle(band.start, band.size, &band.j0, &band.j1);
	return band;
}

static bool is_across(const struct plan_field *u, uint32_t x, uint32_t j)
{
	float dx = u->ux[j][x + 1] - u->ux[j][x], dy = u->uy[j][x + 1] - u->uy[j][x];
	float down_x = u->ux[j + 1][x] - u->ux[j][x], down_y = u->uy[j + 1][x] - u->uy[j][x];
	return dx * dx + dy * dy >= down_x * down_x + down_y * down_y;
}

/* Puts the vertex of a cell on its strongest discontinuity: between pixel (x, start + j) and the next. */
static void snap(struct plan_grid *grid, const struct band *band, uint32_t c, uint32_t x, uint32_t j)
{
	const struct plan_field *u = &band->u;
	struct plan_vertex_row *row = &grid->ring[grid->row % 2];
	uint32_t y = band->start + j, across = is_across(u, x, j), down = !across;
	struct side self = {u->ux[j][x], u->uy[j][x], pixel_depth(grid, x, y)};
	struct side other = {u->ux[j + down][x + across], u->uy[j + down][x + across],
						 pixel_depth(grid, x + across, y + down)};
	const struct side *side = nearer(&other, &self) ? &other : &self;
	row->x[c + 1] = (float)x + (across ? 1.0f : 0.5f);
	row->y[c + 1] = (float)y + (across ? 0.5f : 1.0f);
	row->ux[c + 1] = side->ux;
	row->uy[c + 1] = side->uy;
	row->z[c + 1] = side->z;
	row->snapped[c + 1] = 1;
}

/* Looks for all first, so that the depths are on their way when they are needed. */
static void snap_cells(struct plan_grid *grid, const struct band *band)
{
	uint32_t cell = grid->plan->cell, count = 0;
	for (uint32_t c = 0; c < grid->cells_x; c++) {
		if (grid->largest[c] < grid->least)
			continue;
		struct plan_cell at = {c * cell, extent(c * cell, cell, grid->plan->width), band->size};
		uint32_t k = quantised(grid->largest[c]);
		uint32_t found = grid->kernels->locate(&band->u, &at, (float)(k * k) / 16.0f);
		if (grid->rows.data)
			plan_rows_expect(&grid->rows, at.x + found % 64, band->start + found / 64);
		grid->snaps[count] = c;
		grid->found[count++] = found;
	}
	for (uint32_t i = 0; i < count; i++)
		snap(grid, band, grid->snaps[i], grid->snaps[i] * cell + grid->found[i] % 64, grid->found[i] / 64);
	grid->counts.snapped += count;
}

/* u of vertices that do not snap. */
static void put_means(struct plan_grid *grid, const struct band *band)
{
	struct plan_vertex_row *row = &grid->ring[grid->row % 2];
	const float *upper_x = band->u.ux[band->j0 - band->start], *upper_y = band->u.uy[band->j0 - band->start];
	const float *lower_x = band->u.ux[band->j1 - band->start], *lower_y = band->u.uy[band->j1 - band->start];
	for (uint32_t c = 0; c < grid->cells_x; c++) {
		uint32_t i0 = grid->first[c], i1 = grid->second[c];
		row->ux[c + 1] = ((upper_x[i0] + lower_x[i0]) + (upper_x[i1] + lower_x[i1])) * 0.25f;
		row->uy[c + 1] = ((upper_y[i0] + lower_y[i0]) + (upper_y[i1] + lower_y[i1])) * 0.25f;
	}
}

static void start_cell_row(struct plan_grid *grid, const struct band *band)
{
	read_middle(grid, band->j0, band->j1);
	start_row(grid, (float)band->start + 0.5f * (float)band->size, grid->z_second);
}

void plan_grid_still_row(struct plan_grid *grid, uint32_t r)
{
	if (keep_row(grid))
		return;
	struct band band = band_of(grid, r);
	start_cell_row(grid, &band);
	put_row(grid);
}

void plan_grid_moving_row(struct plan_grid *grid, uint32_t r)
{
	struct band band = band_of(grid, r);
	band.u = plan_motion_field(grid->motion, band.start);
	start_cell_row(grid, &band);
	grid->ring[grid->row % 2].still = false;
	put_means(grid, &band);
	grid->kernels->band_peaks(&band.u, band.size, grid->plan->width, grid->peaks);
	grid->kernels->cell_peaks(grid->peaks, grid->plan->width, grid->plan->cell, grid->largest);
	snap_cells(grid, &band);
	put_row(grid);
}

void plan_grid_end(struct plan_grid *grid, uint32_t r)
{
	if (r == grid->cells_y)
		put_border(grid, grid->plan->height - 1, (float)grid->plan->height);
}

static void count_row(struct plan_grid *grid, uint32_t index)
{
	const struct plan_vertex *vertex = grid->plan->vertices + (size_t)index * grid->plan->columns;
	struct plan_vertex_row *row = &grid->ring[index % 2];
	struct plan_grid_counts *counts = &grid->counts;
	float largest = sqrtf(grid->kernels->largest_square(row->ux, row->uy, grid->plan->columns));
	counts->max_displacement = largest > counts->max_displacement ? largest : counts->max_displacement;
	row->still = largest == 0.0f;
	for (uint32_t i = 0; i < grid->plan->columns; i++) {
		counts->snapped += vertex[i].snapped != 0.0f;
		row->still &= vertex[i].snapped == 0.0f;
	}
}

void plan_grid_take(struct plan_grid *grid)
{
	for (grid->row = 0; grid->row < grid->plan->rows; grid->row++) {
		take_row(grid, grid->row);
		count_row(grid, grid->row);
		if (grid->row)
			put_quads(grid);
	}
}
