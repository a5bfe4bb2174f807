/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The plan's grid, and which of its triangles need what at a phase. Triangles
 * of a displaced grid whose border is fixed lie over each other only where
 * others turn over, so that depth and drawing order matter only there. Knows no
 * executor; memory grows and stays.
 */
#ifndef PURSUIT_ENGINE_WARP_MESH_H
#define PURSUIT_ENGINE_WARP_MESH_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/engine/merge.h"
#include "daemon/engine/plan.h"
#include "daemon/engine/tiles.h"
#include "daemon/error.h"

/* Part of the mesh's lists; indices, not triangles. */
struct warp_list {
	uint32_t first, count;
};

enum { WARP_PLAIN = 0, WARP_TORN, WARP_FOLDED, WARP_FOLDED_TORN, WARP_LISTS };

/* Of a chunk of triangles: what drawing it costs; how many indices it has for each list, then where they go. */
struct warp_share {
	double cost; /* pixels */
	uint32_t at[WARP_LISTS];
};

struct pool;

struct warp_mesh {
	const struct plan *plan;
	struct pool *pool; /* shares the work where there is enough: no bit depends on it; NULL: alone */
	struct merge merge;
	struct tiles folds;  /* at the phase sorted for, where triangles may lie over each other */
	struct tiles low;    /* of the source, where L is needed up to the last phase */
	struct tiles levels; /* and where the pyramid under it is */
	uint32_t *triangles; /* merged, 3 indices each */
	uint32_t count;      /* indices of them */
	float tolerance;     /* pixels that a vertex may be off; 0: none are merged */
	float *wildness;     /* by triangle: squared norm of the displacement's gradient */
	uint8_t *kinds;      /* by triangle: what it needs at the phase sorted for */
	struct warp_share *shares;
	uint32_t *lists;     /* of indices into the plan's vertices: all lists below, one after another */
	uint32_t list_count; /* indices in use */
	uint32_t capacity;   /* indices */
	uint64_t begun;      /* counts warp_mesh_begin(): the vertices are new */
	uint64_t sorted;     /* counts the sorts: the lists are new */
	/* What warp_mesh_sort() and warp_mesh_sort_doubtful() found; `lists` holds one or the other, in this order. */
	struct warp_list plain;       /* neither torn nor over each other */
	struct warp_list torn;        /* torn, not over each other */
	struct warp_list folded;      /* perhaps over each other, in drawing order */
	struct warp_list folded_torn; /* these among them that are torn; if `keep_order` they are in `folded` too */
	bool test_all; /* set by the caller: sorts take all triangles for such that may lie over each other */
	bool keep_order;
	bool too_wild;             /* drawing would cost too much; the lists are not filled */
	struct warp_list doubtful; /* within the tiles of `low` */
};

/*
 * Takes the plan, which must stay until the next one. `tolerance`: pixels that a vertex may be
 * off for cells to be merged; negative: none are. `pool` is used by the sorts too. 0 or -ENOMEM with a sentence:
 * then `count` is 0 and it is to be called again before the next sort.
 */
int warp_mesh_begin(struct warp_mesh *mesh, const struct plan *plan, float tolerance, struct pool *pool,
					struct error *error);
/* Memory that it holds. */
uint64_t warp_mesh_bytes(const struct warp_mesh *mesh);
void warp_mesh_finish(struct warp_mesh *mesh);

/* Unmarks all of `low` and `levels` for a picture of that size. 0 or -ENOMEM with a sentence. */
int warp_mesh_begin_tiles(struct warp_mesh *mesh, uint32_t width, uint32_t height, uint32_t level, struct error *error);

/*
 * Fills `doubtful`: triangles with a blur weight, and marks in `low` and `levels` what they and torn ones need up to
 * the last phase; the spline over `level` reaches far. 0 or -ENOMEM with a sentence.
 */
int warp_mesh_sort_doubtful(struct warp_mesh *mesh, uint32_t level, struct error *error);

/*
 * Fills the lists for a phase; without `tears` none is torn. `keep_order`: depths may be equal, so that what lies over
 * each other is drawn as one list. 0 or -ENOMEM with a sentence.
 *
 * Motion is the client's, and could make each triangle as large as the picture. Where the boxes around those that are
 * stretched, each 8 pixels wider and higher than it is and cut at the picture, together have more pixels than
 * warp_mesh_most_pixels(), `too_wild` is set and nothing else: no time or memory is spent on such a mesh.
 */
int warp_mesh_sort(struct warp_mesh *mesh, float phase, bool tears, bool keep_order, struct error *error);

/* 16 Mi and 16 times the picture; the scenes of client/scenes need at most 1.5 times the picture. */
uint64_t warp_mesh_most_pixels(uint32_t width, uint32_t height);

void warp_mesh_draw(const struct warp_mesh *mesh, struct warp_list list);

/* Of one triangle (3 indices) at a phase: w and t of docs/method.md, 5, both 0 to 1. */
double warp_mesh_weight(const struct warp_mesh *mesh, const uint32_t *index, float phase);
double warp_mesh_tear(const struct warp_mesh *mesh, const uint32_t *index, float phase);

#endif
