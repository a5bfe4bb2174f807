/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <math.h>

#include "daemon/engine/plan.h"

struct range {
	uint32_t first, last;
};

/* Vertices along one axis of the triangles that may cover a tile; vertex i + 1 is that of cell i. */
static struct range vertices_of(uint32_t tile, uint32_t size, uint32_t cell, uint32_t count)
{
	uint32_t from = tile * PLAN_TILE, to = from + PLAN_TILE < size ? from + PLAN_TILE : size;
	uint32_t last = (to - 1) / cell + 2;
	return (struct range){from / cell, last < count ? last : count - 1};
}

enum plan_tile_class plan_tile_class(const struct plan *plan, uint32_t column, uint32_t row, float tolerance)
{
	if (plan->invalid_tiles && plan->invalid_tiles[row * plan_tiles_along(plan->width) + column])
		return PLAN_TILE_INVALID;
	if (!plan->columns)
		return PLAN_TILE_STILL;
	struct range x = vertices_of(column, plan->width, plan->cell, plan->columns);
	struct range y = vertices_of(row, plan->height, plan->cell, plan->rows);
	const struct plan_vertex *first = &plan->vertices[y.first * plan->columns + x.first];
	bool still = true, uniform = true;
	for (uint32_t j = y.first; j <= y.last; j++)
		for (uint32_t i = x.first; i <= x.last; i++) {
			const struct plan_vertex *vertex = &plan->vertices[j * plan->columns + i];
			if (vertex->snapped != 0.0f)
				return PLAN_TILE_DISCONTINUOUS;
			still = still && vertex->ux == 0.0f && vertex->uy == 0.0f;
			uniform =
				uniform && fabsf(vertex->ux - first->ux) <= tolerance && fabsf(vertex->uy - first->uy) <= tolerance;
		}
	return still ? PLAN_TILE_STILL : uniform ? PLAN_TILE_UNIFORM : PLAN_TILE_SMOOTH;
}

void plan_count_tiles(const struct plan *plan, float tolerance, uint32_t counts[PLAN_TILE_CLASSES])
{
	for (int i = 0; i < PLAN_TILE_CLASSES; i++)
		counts[i] = 0;
	for (uint32_t row = 0; row < plan_tiles_along(plan->height); row++)
		for (uint32_t column = 0; column < plan_tiles_along(plan->width); column++)
			counts[plan_tile_class(plan, column, row, tolerance)]++;
}
