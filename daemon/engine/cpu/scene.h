/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Everything that drawing the displaced grid needs to know, and the triangles by
 * the tiles of the displayed picture that they may touch.
 */
#ifndef PURSUIT_ENGINE_CPU_SCENE_H
#define PURSUIT_ENGINE_CPU_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/engine/contents.h"
#include "daemon/engine/cpu/canvas.h"
#include "daemon/engine/warp_mesh.h"

/* Place of a triangle's first index in the mesh's lists, by tile, in drawing order. */
struct bins {
	uint32_t columns, rows; /* of tiles */
	uint32_t *starts;       /* columns x rows + 1: where the triangles of a tile begin */
	uint32_t *cursors;      /* by chunk of triangles and tile: how many there are, then where they go */
	uint32_t *triangles;
	struct bin_range *ranges; /* by triangle: which tiles */
	size_t start_bytes, cursor_bytes, triangle_bytes, range_bytes;
};

struct scene {
	/* The mesh at the phase, and how it is drawn. */
	const struct warp_mesh *mesh;
	float phase;
	float tolerance;    /* pixels of displacement that do not show; negative: all do */
	const float *x, *y; /* displaced vertices, pixels */
	float *positions;   /* where they lie */
	size_t position_bytes;
	bool tears; /* there are torn triangles */
	struct bins bins;
	/* What is drawn, and where. */
	const struct canvas *picture, *low;
	enum picture_id id; /* the picture's */
	const struct contents *contents;
	const struct sheet *sheet;
	uint32_t width, height;
	bool check; /* for tests: count in each scratch what is left uncovered */
};

/* What a thread needs while it draws a tile. */
struct scene_scratch {
	/* Where each pixel comes from: texels of the picture, 16 bits of fraction. */
	_Alignas(64) int32_t x[TILE_PIXELS];
	_Alignas(64) int32_t y[TILE_PIXELS];
	float depth[TILE_PIXELS];
	int16_t tear[TILE_PIXELS]; /* 0 to 1 << TEAR_BITS */
	uint32_t low[TILE_WIDTH];
	uint64_t uncovered;
};

#define TEAR_BITS 14

#endif
