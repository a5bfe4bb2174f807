/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/analysis/kept.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/analysis/facts.h"
#include "daemon/engine/analysis/rows.h"

/* Damage is in pixels of colour. */
static bool is_as_large(const struct pursuit_frame_header *header, uint32_t role, uint32_t width, uint32_t height)
{
	const int index = plan_find_plane(header, role);
	return index < 0 || (header->planes[index].width == width && header->planes[index].height == height);
}

bool plan_kept_follows(const struct plan *plan, const struct frame *frame, const struct plan_params *params)
{
	const struct pursuit_frame_header *header = &frame->header;
	return params->damage && plan->kept && plan->kept->clean && header->damage_since == plan->frame_id &&
		   is_as_large(header, PURSUIT_ROLE_COLOR, plan->width, plan->height) &&
		   is_as_large(header, PURSUIT_ROLE_MOTION, plan->width, plan->height) &&
		   is_as_large(header, PURSUIT_ROLE_DEPTH, plan->width, plan->height);
}

static uint32_t cells_along(uint32_t size, uint32_t cell)
{
	return (size + cell - 1) / cell;
}

int plan_kept_reserve(struct plan *plan)
{
	const uint32_t rows = cells_along(plan->height, plan->cell) + 2;
	if (plan->kept && rows <= plan->kept->capacity)
		return 0;
	free(plan->kept);
	plan->kept = malloc(sizeof(*plan->kept) + rows);
	if (!plan->kept)
		return -ENOMEM;
	*plan->kept = (struct plan_kept){.capacity = rows};
	return 0;
}

static bool is_touched(const struct plan_params *params, uint64_t first, uint64_t last)
{
	for (uint32_t i = 0; i < params->damage_count; i++) {
		const uint64_t top = params->damage[i].y, bottom = top + params->damage[i].height;
		if (top <= last && first < bottom)
			return true;
	}
	return false;
}

/* Do z of vertices mean what they meant? If not, what is remembered from now on is of this frame. */
static bool same_depths(struct plan *plan, const struct pursuit_frame_header *header)
{
	struct plan_kept *kept = plan->kept;
	const struct plan_depth depth = plan_depth_of(header);
	const bool same = kept->width == plan->width && kept->height == plan->height && kept->cell == plan->cell &&
					  kept->depth_kind == header->depth_kind && memcmp(&kept->depth, &depth, sizeof(depth)) == 0;
	kept->width = plan->width;
	kept->height = plan->height;
	kept->cell = plan->cell;
	kept->depth_kind = header->depth_kind;
	kept->depth = depth;
	return same;
}

void plan_kept_begin(struct plan *plan, const struct frame *frame, const struct plan_params *params, bool follows)
{
	const uint32_t cell = plan->cell, cells = cells_along(plan->height, cell);
	const bool keeps = same_depths(plan, &frame->header) && follows;
	uint8_t *rows = plan->kept->rows;
	for (uint32_t r = 0; r < cells; r++) {
		const bool touched = !follows || is_touched(params, (uint64_t)r * cell, (uint64_t)r * cell + cell);
		const uint8_t still = keeps && !touched ? PLAN_KEPT_STILL : 0;
		rows[r + 1] = (uint8_t)((rows[r + 1] & still) | (touched ? PLAN_KEPT_TOUCHED : 0));
		/* The borders' vertices have depths of the outermost cells. */
		if (r == 0)
			rows[0] = (uint8_t)((rows[0] & still) | PLAN_KEPT_TOUCHED);
		if (r + 1 == cells)
			rows[r + 2] = (uint8_t)((rows[r + 2] & still) | PLAN_KEPT_TOUCHED);
	}
}

void plan_kept_end(struct plan *plan)
{
	plan->kept->clean = plan->invalid_pixels == 0;
}
