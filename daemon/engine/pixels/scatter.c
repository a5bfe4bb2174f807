/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pixels/scatter.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static int reserve(struct scatter *scatter, uint32_t width, uint32_t height, struct error *error)
{
	size_t pixels = (size_t)width * height;
	if (pixels > scatter->capacity) {
		free(scatter->source);
		free(scatter->values);
		free(scatter->valid);
		scatter->capacity = 0;
		scatter->source = malloc(pixels * sizeof(*scatter->source));
		scatter->values = malloc(3 * pixels * sizeof(*scatter->values));
		scatter->valid = malloc(pixels);
		if (!scatter->source || !scatter->values || !scatter->valid)
			return error_set(error, -ENOMEM, "out of memory to scatter a picture of %u x %u", width, height);
		scatter->capacity = pixels;
	}
	scatter->width = width;
	scatter->height = height;
	return 0;
}

int scatter_make(struct scatter *scatter, const struct plan_dense *dense, double phase, struct error *error)
{
	const uint32_t width = dense->width, height = dense->height;
	const float shift = (float)phase;
	int result = reserve(scatter, width, height, error);
	if (result < 0)
		return result;
	uint32_t *source = scatter->source, landed = 0, at = 0;
	memset(source, 0xff, (size_t)width * height * sizeof(*source));
	for (uint32_t j = 0; j < height; j++)
		for (uint32_t i = 0; i < width; i++, at++) {
			const float x = (float)i + 0.5f + shift * dense->ux[at], y = (float)j + 0.5f + shift * dense->uy[at];
			if (!(x >= 0.0f && y >= 0.0f && x < (float)width && y < (float)height))
				continue;
			uint32_t *target = &source[(size_t)(uint32_t)y * width + (uint32_t)x];
			landed += *target == SCATTER_HOLE;
			if (*target == SCATTER_HOLE || dense->z[at] < dense->z[*target])
				*target = at;
		}
	scatter->holes = width * height - landed;
	return 0;
}

static void show_sources(struct scatter *scatter, const struct plan_dense *dense, float shift,
						 const struct bitmap *from, struct bitmap *to)
{
	size_t at = 0;
	for (uint32_t j = 0; j < scatter->height; j++)
		for (uint32_t i = 0; i < scatter->width; i++, at++) {
			const uint32_t source = scatter->source[at];
			scatter->valid[at] = source != SCATTER_HOLE;
			if (source == SCATTER_HOLE)
				continue;
			const struct color color = bitmap_sample(from, (float)i + 0.5f - shift * dense->ux[source],
													 (float)j + 0.5f - shift * dense->uy[source]);
			memcpy(scatter->values + 3 * at, color.c, sizeof(color.c));
			bitmap_put(to->data + 4 * at, color.c);
		}
}

int scatter_show(struct scatter *scatter, const struct plan_dense *dense, double phase, const struct bitmap *from,
				 struct bitmap *to, struct error *error)
{
	const size_t pixels = (size_t)scatter->width * scatter->height;
	if (scatter->holes == pixels) {
		memcpy(to->data, from->data, 4 * pixels);
		return 0;
	}
	show_sources(scatter, dense, (float)phase, from, to);
	if (!scatter->holes)
		return 0;
	const struct pull_push_plane plane = {scatter->width, scatter->height, 3, scatter->values, scatter->valid};
	int result = pull_push_fill(&scatter->fill, &plane, error);
	for (size_t at = 0; at < pixels && result == 0; at++)
		if (!scatter->valid[at])
			bitmap_put(to->data + 4 * at, scatter->values + 3 * at);
	return result;
}

void scatter_finish(struct scatter *scatter)
{
	free(scatter->source);
	free(scatter->values);
	free(scatter->valid);
	pull_push_finish(&scatter->fill);
	*scatter = (struct scatter){0};
}
