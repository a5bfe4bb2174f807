/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/plan.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "daemon/engine/analysis/bands.h"
#include "daemon/engine/analysis/facts.h"
#include "daemon/engine/analysis/job.h"
#include "daemon/engine/analysis/kept.h"

static void reset(struct plan *plan, const struct frame *frame, const struct plan_params *params)
{
	const struct pursuit_frame_header *header = &frame->header;
	int colour = plan_find_plane(header, PURSUIT_ROLE_COLOR);
	uint32_t cell = params->cell ? params->cell : 8;
	plan->frame_id = header->frame_id;
	plan->width = colour < 0 ? 0 : header->planes[colour].width;
	plan->height = colour < 0 ? 0 : header->planes[colour].height;
	plan->cell = cell < 4 ? 4 : cell > PLAN_MAX_CELL ? PLAN_MAX_CELL : cell;
	plan->rest = PLAN_MOVES;
	plan->last_phase = params->last_phase > 0 ? fminf(params->last_phase, 8.0f) : 0.0f;
	plan->columns = plan->rows = plan->index_count = 0;
	plan->snapped = plan->folded = plan->doubtful = 0;
	plan->invalid_pixels = 0;
	plan->invalid_tiles = NULL;
	plan->max_displacement = 0;
	if (plan->kept)
		plan->kept->clean = false;
}

/* Cuts the scratch into buffers, after growing it if it is too small. */
static int prepare(struct plan *plan, struct plan_bands *bands, const struct frame *frame)
{
	struct plan_arena arena = {NULL, 0};
	plan_bands_init(bands, frame, &arena);
	if (plan_scratch_reserve(plan, &arena) < 0 || plan_kept_reserve(plan) < 0)
		return -ENOMEM;
	plan_bands_init(bands, frame, &arena);
	return plan_grid_reserve(plan);
}

int plan_out_of_memory(struct plan *plan, struct error *error)
{
	plan->columns = plan->rows = 0;
	return error_set(error, -ENOMEM, "no memory for the plan of a %u x %u picture with cells of %u pixels", plan->width,
					 plan->height, plan->cell);
}

struct plan_intervals plan_begin(struct plan *plan, const struct frame *frame, const struct plan_params *params)
{
	struct plan_intervals intervals = plan_intervals_of(&frame->header, params->real_interval_ns);
	reset(plan, frame, params);
	plan->real_interval_s = (double)intervals.real * 1e-9;
	plan->rest = params->unchanged ? PLAN_UNCHANGED : plan_rest_of(frame, &intervals);
	return intervals;
}

int plan_make_with(struct plan *plan, const struct frame *frame, const struct plan_params *params,
				   const struct plan_kernels *kernels, struct error *error)
{
	const bool follows = plan_kept_follows(plan, frame, params);
	struct plan_intervals intervals = plan_begin(plan, frame, params);
	if (plan->rest == PLAN_UNCHANGED && follows)
		plan->kept->clean = true;
	if (plan->rest != PLAN_MOVES)
		return 0;
	struct plan_bands bands = {
		.plan = plan, .pool = params->pool, .kernels = kernels, .threshold = plan_threshold(params)};
	bands.scale = plan_scale_make(plan->real_interval_s, (double)intervals.motion * 1e-9, plan->width, params);
	if (prepare(plan, &bands, frame))
		return plan_out_of_memory(plan, error);
	plan_kept_begin(plan, frame, params, follows);
	plan_bands_run(&bands);
	plan_kept_end(plan);
	return 0;
}

int plan_make(struct plan *plan, const struct frame *frame, const struct plan_params *params, struct error *error)
{
	/* Asking the machine costs microseconds: the CPUID instruction leaves a virtual machine. */
	if (!plan->kernels)
		plan->kernels = plan_level_kernels(plan_level_best());
	return plan_make_with(plan, frame, params, plan->kernels, error);
}

uint64_t plan_bytes(const struct plan *plan)
{
	return plan->vertex_capacity * (uint64_t)sizeof(*plan->vertices) +
		   plan->index_capacity * (uint64_t)sizeof(*plan->indices) + plan->scratch_bytes +
		   (plan->kept ? sizeof(*plan->kept) + plan->kept->capacity : 0);
}

void plan_finish(struct plan *plan)
{
	if (!plan)
		return;
	free(plan->vertices);
	free(plan->indices);
	free(plan->scratch);
	free(plan->kept);
	*plan = (struct plan){0};
}
