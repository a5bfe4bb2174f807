/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The grid of vertices and its triangles (docs/method.md, 2), row by row from the top, by bands of rows: threads work
 * on different bands, each with a struct plan_grid of its own for the same plan.
 */
#ifndef PURSUIT_ANALYSIS_GRID_H
#define PURSUIT_ANALYSIS_GRID_H

#include "daemon/engine/analysis/field.h"

/* What a band adds to the plan. */
struct plan_grid_counts {
	uint32_t snapped, folded, doubtful;
	float max_displacement;
};

struct plan_grid {
	const struct plan_kernels *kernels;
	struct plan *plan; /* sizes are read, vertices and indices of the band's rows are written */
	const struct plan_motion *motion;
	uint32_t cells_x, cells_y;
	float least;              /* g² of q_min */
	float *peaks;             /* g² by column of pixels */
	float *largest;           /* g² by cell */
	uint32_t *snaps;          /* cells of the row in work that snap, and */
	uint32_t *found;          /* where: row << 6 | column in the cell */
	float *centres;           /* x of the centres of cells */
	uint32_t *first, *second; /* i0 and i1 of the cells */
	/* depth */
	struct plan_rows rows; /* without data: z is 0.5 */
	struct plan_depth depth;
	float *z, *z_second; /* a row of pixels, the smaller of j0 and j1, and j1 */
	/* vertices: the row before and the one in work */
	struct plan_vertex_row ring[2];
	bool absent[2]; /* they are in the plan only: still ones that were kept */
	uint32_t *diagonals;
	uint32_t row; /* in work, 0: the upper border */
	bool follows; /* the other row of the ring is the one above it */
	struct plan_grid_counts counts;
};

void plan_grid_init(struct plan_grid *grid, const struct frame *frame, uint32_t cell, uint32_t threshold,
					struct plan_arena *arena);

/* Gives the plan scratch for all that was taken from the arena, which was only counted; the arena then begins there. 0
 * or -ENOMEM. */
int plan_scratch_reserve(struct plan *plan, struct plan_arena *arena);

/* Makes room for the vertices and triangles of a plan whose width, height and cell are set, sets columns and rows. 0 or
 * -ENOMEM. */
int plan_grid_reserve(struct plan *plan);

/* A band begins with cell row r; the first one with the vertices on the picture's upper border. */
void plan_grid_begin(struct plan_grid *grid, uint32_t r);

/* Vertices of cell row r, where nothing moves; or where u of its rows and the one below is in the ring. */
void plan_grid_still_row(struct plan_grid *grid, uint32_t r);
void plan_grid_moving_row(struct plan_grid *grid, uint32_t r);

/* The band ends before cell row r; the last one with the lower border. */
void plan_grid_end(struct plan_grid *grid, uint32_t r);

/* The triangles above the first vertices of a band that begins with cell row r > 0, when both bands are done. */
void plan_grid_join(struct plan_grid *grid, uint32_t r);

/* Instead of all that: triangles and counts of vertices that are in the plan already. */
void plan_grid_take(struct plan_grid *grid);

#endif
