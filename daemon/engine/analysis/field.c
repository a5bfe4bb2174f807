/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/analysis/field.h"

#include <math.h>
#include <string.h>

enum plan_slot {
	SLOT_UNKNOWN = 0,
	SLOT_STILL, /* u is 0 all over */
	SLOT_MOVES,
};

struct plan_scale plan_scale_make(double real_s, double motion_s, uint32_t width, const struct plan_params *params)
{
	double display = params->display_width_mm > 0 ? (double)params->display_width_mm : 531.0;
	double distance = params->viewing_distance_mm > 0 ? (double)params->viewing_distance_mm : 600.0;
	double pixel = atan(display / width / distance) * (180.0 / 3.14159265358979323846);
	double ratio = fmin(fmax(real_s / motion_s, 0.125), 8.0);
	struct plan_scale scale = {.ratio = (float)ratio, .degrees = isfinite(pixel) ? (float)(pixel / motion_s) : 0.0f};
	double plain = fmin(fmin(70.0 / (double)scale.degrees, 16384.0 / ratio), 65504.0);
	/* A little less, so that what rounds to the limit is looked at with care. */
	scale.plain_squared = (float)(plain * plain * 0.999);
	return scale;
}

/* Some pixels of row y are invalid: which tiles are they in? */
static void mark_invalid(const struct plan_motion *motion, uint32_t y, const float *motions)
{
	if (!motion->invalid_tiles)
		return;
	uint8_t *tiles = motion->invalid_tiles + (size_t)(y / PLAN_TILE) * plan_tiles_along(motion->width);
	for (uint32_t i = 0; i < motion->width; i++)
		if (!isfinite(motions[2 * (size_t)i]) || !isfinite(motions[2 * (size_t)i + 1]))
			__atomic_store_n(&tiles[i / PLAN_TILE], 1, __ATOMIC_RELAXED);
}

void plan_motion_init(struct plan_motion *motion, const struct frame *frame, uint32_t cell, struct plan_arena *arena)
{
	plan_rows_init(&motion->rows, frame, PURSUIT_ROLE_MOTION, arena);
	motion->half = motion->rows.pixel_bytes == 4;
	motion->width = motion->rows.colour_width;
	motion->height = motion->rows.colour_height;
	motion->invalid = 0;
	motion->invalid_tiles = NULL;
	motion->ring = cell + 1;
	motion->stride = (motion->width + 16) / 16 * 16;
	motion->ux = plan_arena_take(arena, motion->ring * motion->stride * sizeof(float));
	motion->uy = plan_arena_take(arena, motion->ring * motion->stride * sizeof(float));
	motion->decoded = plan_arena_take(arena, 2 * (size_t)motion->width * sizeof(float));
	plan_motion_begin(motion, motion->height);
}

void plan_motion_begin(struct plan_motion *motion, uint32_t counted_end)
{
	motion->counted_end = counted_end;
	memset(motion->slots, SLOT_UNKNOWN, sizeof(motion->slots));
}

static bool is_zero(const struct plan_motion *motion, uint32_t y)
{
	const uint8_t *row = plan_rows_source(&motion->rows, y);
	if ((uintptr_t)row % 4 != 0)
		return false;
	size_t words = (size_t)motion->rows.width * motion->rows.pixel_bytes / 4;
	return !motion->kernels->any_bits((const uint32_t *)(const void *)row, words,
									  motion->half ? 0x7fff7fffu : 0x7fffffffu);
}

static void clear(struct plan_motion *motion, uint32_t slot)
{
	if (motion->slots[slot] == SLOT_STILL)
		return;
	memset(motion->ux + slot * motion->stride, 0, motion->stride * sizeof(float));
	memset(motion->uy + slot * motion->stride, 0, motion->stride * sizeof(float));
	motion->slots[slot] = SLOT_STILL;
}

static void repeat(struct plan_motion *motion, uint32_t slot)
{
	uint32_t last = (slot ? slot : motion->ring) - 1;
	size_t stride = motion->stride;
	memcpy(motion->ux + slot * stride, motion->ux + last * stride, stride * sizeof(float));
	memcpy(motion->uy + slot * stride, motion->uy + last * stride, stride * sizeof(float));
	motion->slots[slot] = motion->slots[last];
}

void plan_motion_load(struct plan_motion *motion, uint32_t y)
{
	const struct plan_kernels *kernels = motion->kernels;
	uint32_t slot = y % motion->ring, width = motion->width;
	if (y >= motion->height) {
		repeat(motion, slot);
		return;
	}
	if (is_zero(motion, y)) {
		clear(motion, slot);
		return;
	}
	plan_rows_expect_row(&motion->rows, y + 1);
	const void *raw = plan_rows_get(&motion->rows, y);
	if (motion->half)
		kernels->decode_half(raw, 2 * (size_t)width, motion->decoded);
	const float *motions = motion->half ? motion->decoded : raw;
	float *ux = motion->ux + slot * motion->stride, *uy = motion->uy + slot * motion->stride;
	uint32_t seen = kernels->scale_row(motions, width, &motion->scale, ux, uy);
	if (seen & PLAN_ROW_ODD) {
		uint64_t invalid = 0;
		seen = kernels->careful_row(motions, width, &motion->scale, ux, uy, &invalid);
		if (invalid && y < motion->counted_end) {
			motion->invalid += invalid;
			mark_invalid(motion, y, motions);
		}
	}
	ux[width] = ux[width - 1];
	uy[width] = uy[width - 1];
	motion->slots[slot] = seen & PLAN_ROW_MOVES ? SLOT_MOVES : SLOT_UNKNOWN;
}

bool plan_motion_moves(const struct plan_motion *motion, uint32_t y)
{
	return motion->slots[y % motion->ring] == SLOT_MOVES;
}

struct plan_field plan_motion_field(const struct plan_motion *motion, uint32_t y)
{
	struct plan_field field;
	uint32_t slot = y % motion->ring;
	for (uint32_t j = 0; j < motion->ring; j++) {
		field.ux[j] = motion->ux + slot * motion->stride;
		field.uy[j] = motion->uy + slot * motion->stride;
		slot = slot + 1 < motion->ring ? slot + 1 : 0;
	}
	return field;
}
