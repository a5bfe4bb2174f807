/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The plan: what one real frame needs, found on the CPU from depth and motion
 * where they lie, without GL (docs/method.md, 1, 2 and 8; Didyk et al. 2010,
 * Section 6). Plain data; printable; GL is its first executor.
 */
#ifndef PURSUIT_ENGINE_PLAN_H
#define PURSUIT_ENGINE_PLAN_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "daemon/frame.h"

/* Why a frame is not extrapolated. */
enum plan_rest {
	PLAN_MOVES = 0, /* it is */
	PLAN_STILL,
	PLAN_CUT,
	PLAN_MOTION_INVALID,
	PLAN_NO_MOTION,
	PLAN_NO_INTERVAL,
	PLAN_UNCHANGED, /* its client says so; nobody looked */
};

struct pool;

struct plan_params {
	uint32_t cell;              /* 4 to 64 pixels, clamped; 0: 8 */
	uint32_t threshold_quarter; /* q_min in quarter pixels, 1 to 63, clamped; 0: 2 */
	float display_width_mm;     /* > 0; 0: 531 (24 inch, 16:9) */
	float viewing_distance_mm;  /* > 0; 0: 600 */
	float last_phase;           /* p_last, 0 to 8; clamped, NaN is 0 */
	uint64_t real_interval_ns;  /* T as the pacer knows it; 0: the frame's own */
	bool unchanged;             /* nothing has changed since the frame before */
	/*
	 * Outside these all planes are as they were in the frame damage_since of the header, and nothing moves there. It
	 * counts if the plan was made of that frame last. NULL: not known.
	 */
	const struct pursuit_rectangle *damage;
	uint32_t damage_count;
	struct pool *pool; /* threads that share the work: no bit depends on them; NULL: the caller alone */
};

/* 24 bytes: what the GPU gets. */
struct plan_vertex {
	float x, y;    /* source position, pixels */
	float ux, uy;  /* displacement over one real interval, pixels */
	float z;       /* normalised depth, 0 near */
	float snapped; /* 1: at a discontinuity, 0: not */
};

/* Pixels a side of the tiles that the plan tells about. */
#define PLAN_TILE 64u

static inline uint32_t plan_tiles_along(uint32_t size)
{
	return (size + PLAN_TILE - 1) / PLAN_TILE;
}

/* What a tile's triangles need; the first of INVALID, DISCONTINUOUS, STILL, UNIFORM that fits. */
enum plan_tile_class {
	PLAN_TILE_STILL = 0,     /* no vertex moves */
	PLAN_TILE_UNIFORM,       /* all vertices move alike within the tolerance asked for */
	PLAN_TILE_SMOOTH,        /* no vertex is snapped */
	PLAN_TILE_DISCONTINUOUS, /* some are */
	PLAN_TILE_INVALID,       /* motion there is no number */
	PLAN_TILE_CLASSES,
};

struct plan_kernels;
struct plan_kept;

struct plan {
	uint64_t frame_id;
	uint32_t width, height; /* of colour */
	uint32_t cell;
	enum plan_rest rest;
	double real_interval_s; /* T, 0 unknown */
	float last_phase;
	uint32_t columns, rows;       /* vertices; 0 if the frame rests */
	struct plan_vertex *vertices; /* columns x rows, row by row */
	uint32_t *indices;            /* triangles, 3 each, in drawing order */
	uint32_t index_count;
	uint32_t snapped;        /* vertices */
	uint32_t folded;         /* triangles that turn over at last_phase */
	uint32_t doubtful;       /* others with stretch(last_phase) > 1.25, that is with w > 0 */
	uint64_t invalid_pixels; /* of the picture: NaN or infinite motion there; 0 without looking if cut and the like */
	float max_displacement;  /* of any vertex, pixels per real interval */
	uint8_t *invalid_tiles;  /* by tile, row by row: some invalid pixel in it; NULL: none. Until the next plan_make() */
	/* owned storage, reused from frame to frame; no allocation in the steady state */
	uint32_t vertex_capacity, index_capacity;
	void *scratch;
	size_t scratch_bytes;
	struct plan_kept *kept; /* what the next frame's damage may leave as it is; NULL before the first frame */
	const struct plan_kernels *kernels; /* of the machine, found with the first frame */
};

/* A zeroed struct plan is ready for use. */
void plan_finish(struct plan *plan);

/* Memory that it holds. */
uint64_t plan_bytes(const struct plan *plan);

/*
 * Analyses the frame and fills the plan. Reads motion and depth by blocks of
 * rows that it copies first, since the client may change them meanwhile; never
 * fails on values. 0 or -ENOMEM with a sentence. Any thread, one at a time.
 */
int plan_make(struct plan *plan, const struct frame *frame, const struct plan_params *params, struct error *error);

/* "still", "cut", ...; "" for PLAN_MOVES. Static. */
const char *plan_rest_name(enum plan_rest rest);

/*
 * The class of a tile, and how many of each there are. `tolerance`: pixels of displacement over one real interval,
 * as the method merges cells.
 */
enum plan_tile_class plan_tile_class(const struct plan *plan, uint32_t column, uint32_t row, float tolerance);
void plan_count_tiles(const struct plan *plan, float tolerance, uint32_t counts[PLAN_TILE_CLASSES]);

/* One JSON object on one line, with a newline: sizes, counts, rest, bounds; no vertices. */
void plan_print(const struct plan *plan, FILE *out);

#endif
