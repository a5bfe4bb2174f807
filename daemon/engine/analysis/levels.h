/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The vector kernels of the analysis, once per instruction set, and how one is
 * chosen. All levels give equal bits: no contraction, no reassociation, only
 * correctly rounded operations. kernels.h holds the code of all of them.
 */
#ifndef PURSUIT_ANALYSIS_LEVELS_H
#define PURSUIT_ANALYSIS_LEVELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/plan.h"

enum plan_level {
	PLAN_LEVEL_PLAIN = 0, /* what the compiler makes of plain C for the base machine (SSE2, NEON) */
	PLAN_LEVEL_AVX2,      /* with F16C */
	PLAN_LEVEL_AVX512,    /* foundation only */
	PLAN_LEVEL_NEON,      /* 64-bit ARM */
	PLAN_LEVEL_COUNT,
};

/* How motion becomes displacement (docs/method.md, 1). */
struct plan_scale {
	float ratio;         /* T / S, clamped */
	float degrees;       /* speed in degrees per second of one pixel per S */
	float plain_squared; /* |m|² up to here: finite, undamped and unclamped, so u = ratio m */
};

/* What scale_row() saw. */
#define PLAN_ROW_MOVES 1u /* some u is not 0 */
#define PLAN_ROW_ODD 2u   /* some |m|² is beyond plain_squared or no number: u is to be found by careful_row() */

/* How a depth value d becomes z (docs/method.md, 1). */
enum plan_depth_map {
	PLAN_DEPTH_AS_IS = 0,
	PLAN_DEPTH_REVERSED,
	PLAN_DEPTH_RANGE,    /* (d - near) / (far - near) */
	PLAN_DEPTH_INFINITE, /* 1 - near / d */
	PLAN_DEPTH_OPEN,     /* d / (1 + d) */
};

struct plan_depth {
	uint32_t format; /* PURSUIT_FORMAT_DEPTH* */
	enum plan_depth_map map;
	float near_distance;
	float range; /* far - near */
};

/* Rows of u by their place in a cell row, the one below it included; one pixel more than the picture is readable. */
#define PLAN_MAX_CELL 64u

struct plan_field {
	const float *ux[PLAN_MAX_CELL + 1], *uy[PLAN_MAX_CELL + 1];
};

/* A cell's pixels: columns from x on, the first rows of the field. */
struct plan_cell {
	uint32_t x, width, height;
};

/* A row of vertices. */
struct plan_vertex_row {
	float *x, *y, *ux, *uy, *z, *snapped;
	bool still; /* no vertex moves or snaps */
};

struct plan_quad_counts {
	uint32_t folded, doubtful;
};

struct plan_kernels {
	const char *name;
	/* Any bit of the words set, but for those that mask leaves out? */
	bool (*any_bits)(const uint32_t *words, size_t count, uint32_t mask);
	void (*decode_half)(const uint16_t *halves, size_t count, float *values);
	/* To the nearest, ties to even; numbers beyond the largest half become that one, what is no number stays none. */
	void (*encode_half)(const float *values, size_t count, uint16_t *halves);
	/* u of count pixels from interleaved motion, PLAN_ROW_* given back. */
	uint32_t (*scale_row)(const float *motion, size_t count, const struct plan_scale *scale, float *ux, float *uy);
	/* The same for any bits; *invalid grows by the number of pixels that are no numbers. */
	uint32_t (*careful_row)(const float *motion, size_t count, const struct plan_scale *scale, float *ux, float *uy,
							uint64_t *invalid);
	/* peaks[i]: the largest g² of column i of the first `rows` rows; count columns. */
	void (*band_peaks)(const struct plan_field *field, uint32_t rows, size_t count, float *peaks);
	/* Largest of each `cell` peaks, and of the last ones that are fewer. */
	void (*cell_peaks)(const float *peaks, size_t count, uint32_t cell, float *largest);
	/* The pixel of the cell with g² >= least that is nearest to its centre: row << 6 | column. One must exist. */
	uint32_t (*locate)(const struct plan_field *field, const struct plan_cell *cell, float least);
	/* z of count pixels. */
	void (*depth_row)(const void *raw, size_t count, const struct plan_depth *depth, float *z);
	/* Diagonals of the quads between two rows of vertices: 1 is v00 v11, 0 is v10 v01. */
	struct plan_quad_counts (*quads)(const struct plan_vertex_row *upper, const struct plan_vertex_row *lower,
									 size_t count, float phase, uint32_t *diagonals);
	/* The largest ux² + uy². */
	float (*largest_square)(const float *ux, const float *uy, size_t count);
	/* A number of the bytes, another one at each level (row_hash.h). */
	uint64_t (*hash_row)(const uint8_t *row, size_t bytes);
};

/* Kernels of a level; NULL if this build or this machine lacks it. */
const struct plan_kernels *plan_level_kernels(enum plan_level level);

/* The fastest level that this machine has. */
enum plan_level plan_level_best(void);

/* plan_make() with kernels of the caller's choice. */
int plan_make_with(struct plan *plan, const struct frame *frame, const struct plan_params *params,
				   const struct plan_kernels *kernels, struct error *error);

#endif
