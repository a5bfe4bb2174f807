/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pixels/between.h"

#include <stdbool.h>
#include <string.h>

/* How much nearer than what is shown something must be to have covered it: a twentieth of the way to infinity. */
#define NEARER_FACTOR 1.05f
#define NEARER_STEP 0.001f

/* u of what shows at each target pixel, its z kept in the source. */
static int find_motion(struct scatter *scatter, const struct plan_dense *dense, struct error *error)
{
	const size_t pixels = (size_t)scatter->width * scatter->height;
	for (size_t at = 0; at < pixels; at++) {
		const uint32_t source = scatter->source[at];
		scatter->valid[at] = source != SCATTER_HOLE;
		scatter->values[2 * at] = source == SCATTER_HOLE ? 0.0f : dense->ux[source];
		scatter->values[2 * at + 1] = source == SCATTER_HOLE ? 0.0f : dense->uy[source];
	}
	if (!scatter->holes)
		return 0;
	return pull_push_fill(
		&scatter->fill, &(struct pull_push_plane){scatter->width, scatter->height, 2, scatter->values, scatter->valid},
		error);
}

static uint32_t pixel_of(float x, uint32_t size)
{
	return x > 0.0f ? x < (float)size ? (uint32_t)x : size - 1 : 0;
}

static bool was_covered(const struct plan_dense *before, float x, float y, float z)
{
	const float there = before->z[(size_t)pixel_of(y, before->height) * before->width + pixel_of(x, before->width)];
	return 1.0f - there > NEARER_FACTOR * (1.0f - z) + NEARER_STEP;
}

int between_show(struct scatter *scatter, const struct between_frame *now, const struct between_frame *before,
				 double share, struct bitmap *to, struct error *error)
{
	const float ahead = (float)share, back = (float)(share - 1.0);
	int result = scatter_make(scatter, now->dense, share - 1.0, error);
	if (result == 0)
		result = find_motion(scatter, now->dense, error);
	size_t at = 0;
	for (uint32_t j = 0; j < scatter->height && result == 0; j++)
		for (uint32_t i = 0; i < scatter->width; i++, at++) {
			const float ux = scatter->values[2 * at], uy = scatter->values[2 * at + 1];
			const float x = (float)i + 0.5f, y = (float)j + 0.5f, px = x - ahead * ux, py = y - ahead * uy;
			const bool hole = scatter->source[at] == SCATTER_HOLE;
			float weight = hole ? 0.0f : ahead;
			if (!hole && was_covered(before->dense, px, py, now->dense->z[scatter->source[at]]))
				weight = 1.0f;
			struct color from_now = bitmap_sample(now->bitmap, x - back * ux, y - back * uy);
			struct color from_before = bitmap_sample(before->bitmap, px, py);
			for (int c = 0; c < 3; c++)
				from_now.c[c] = from_before.c[c] + weight * (from_now.c[c] - from_before.c[c]);
			bitmap_put(to->data + 4 * at, from_now.c);
		}
	return result;
}
