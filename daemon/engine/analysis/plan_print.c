/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <inttypes.h>

#include "daemon/engine/plan.h"

const char *plan_rest_name(enum plan_rest rest)
{
	switch (rest) {
	case PLAN_STILL:
		return "still";
	case PLAN_CUT:
		return "cut";
	case PLAN_MOTION_INVALID:
		return "motion-invalid";
	case PLAN_NO_MOTION:
		return "no-motion";
	case PLAN_NO_INTERVAL:
		return "no-interval";
	case PLAN_UNCHANGED:
		return "unchanged";
	case PLAN_MOVES:
	default:
		return "";
	}
}

/* What `pursuit` takes for alike: a thirty-second of a pixel. */
#define ALIKE (1.0f / 32.0f)

static void print_tiles(const struct plan *plan, FILE *out)
{
	static const char *const names[PLAN_TILE_CLASSES] = {"still", "uniform", "smooth", "discontinuous", "invalid"};
	uint32_t counts[PLAN_TILE_CLASSES];
	plan_count_tiles(plan, ALIKE, counts);
	for (int i = 0; i < PLAN_TILE_CLASSES; i++)
		fprintf(out, "%s\"%s\": %u", i ? ", " : "\"tiles\": {", names[i], counts[i]);
	fprintf(out, "}, ");
}

void plan_print(const struct plan *plan, FILE *out)
{
	fprintf(out, "{\"frame\": %" PRIu64 ", \"width\": %u, \"height\": %u, \"cell\": %u, \"rest\": \"%s\", ",
			plan->frame_id, plan->width, plan->height, plan->cell, plan_rest_name(plan->rest));
	fprintf(out, "\"real_interval_ms\": %.6f, \"last_phase\": %.6f, ", plan->real_interval_s * 1e3,
			(double)plan->last_phase);
	fprintf(out, "\"columns\": %u, \"rows\": %u, \"vertices\": %u, \"triangles\": %u, ", plan->columns, plan->rows,
			plan->columns * plan->rows, plan->index_count / 3);
	fprintf(out, "\"snapped\": %u, \"folded\": %u, \"doubtful\": %u, \"invalid_pixels\": %" PRIu64 ", ", plan->snapped,
			plan->folded, plan->doubtful, plan->invalid_pixels);
	print_tiles(plan, out);
	fprintf(out, "\"max_displacement\": %.6f}\n", (double)plan->max_displacement);
}
