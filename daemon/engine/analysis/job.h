/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The analysis shared out: what it computes with, for those who look at the
 * planes elsewhere (a GPU), and the plan made of what they found there.
 */
#ifndef PURSUIT_ANALYSIS_JOB_H
#define PURSUIT_ANALYSIS_JOB_H

#include "daemon/engine/analysis/levels.h"

struct plan_job {
	uint32_t width, height; /* of colour */
	uint32_t cell;
	uint32_t columns, rows;        /* vertices to find */
	uint32_t tile_columns, tiles;  /* of PLAN_TILE, along a row and in all */
	float least;                   /* g² from which on a cell snaps */
	struct plan_scale scale;       /* of motion; plain_squared does not matter */
	struct plan_depth depth;       /* how depth becomes z */
	int motion_plane, depth_plane; /* places in the header; depth_plane -1: z is 0.5 */
};

/* What was found; all of it is copied. */
struct plan_found {
	bool moves;                         /* some u is not 0 */
	const struct plan_vertex *vertices; /* columns x rows, row by row */
	uint32_t invalid_pixels;
	const uint32_t *invalid_tiles; /* by tile: not 0 if it holds one */
};

/* Starts the plan of a frame. True: the planes decide, and the job says how; false: the plan rests and is done. */
bool plan_job_begin(struct plan *plan, const struct frame *frame, const struct plan_params *params,
					struct plan_job *job);

/* Triangles, counts and bounds from the vertices. 0 or -ENOMEM with a sentence. */
int plan_job_end(struct plan *plan, const struct frame *frame, const struct plan_job *job,
				 const struct plan_found *found, struct error *error);

/*
 * Forgets what the plan said and fills in what the header alone says, `rest` too. For plan.c and job.c.
 */
struct plan_intervals plan_begin(struct plan *plan, const struct frame *frame, const struct plan_params *params);

/* As error_set() for a plan without room for its parts; it has no vertices then. */
int plan_out_of_memory(struct plan *plan, struct error *error);

#endif
