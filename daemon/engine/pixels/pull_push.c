/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pixels/pull_push.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Level 0 lies in the caller's memory, the others behind each other in ours. */
struct level {
	uint32_t width, height;
	float *values;
	uint8_t *valid;
};

static uint32_t make_levels(struct pull_push *pull_push, const struct pull_push_plane *plane,
							struct level levels[PULL_PUSH_LEVELS])
{
	uint32_t count = 1, width = plane->width, height = plane->height;
	float *values = pull_push->values;
	uint8_t *valid = pull_push->valid;
	levels[0] = (struct level){width, height, plane->values, valid};
	valid += (size_t)width * height;
	while (width > 1 || height > 1) {
		width = (width + 1) / 2;
		height = (height + 1) / 2;
		levels[count++] = (struct level){width, height, values, valid};
		values += (size_t)width * height * plane->channels;
		valid += (size_t)width * height;
	}
	return count;
}

static int reserve(struct pull_push *pull_push, const struct pull_push_plane *plane, struct error *error)
{
	size_t pixels = 0;
	for (uint32_t width = plane->width, height = plane->height; width > 1 || height > 1;) {
		width = (width + 1) / 2;
		height = (height + 1) / 2;
		pixels += (size_t)width * height;
	}
	size_t values = pixels * plane->channels + 1, valid = pixels + (size_t)plane->width * plane->height;
	if (values > pull_push->value_capacity || valid > pull_push->valid_capacity) {
		pull_push_finish(pull_push);
		pull_push->values = malloc(values * sizeof(float));
		pull_push->valid = malloc(valid);
		if (!pull_push->values || !pull_push->valid)
			return error_set(error, -ENOMEM, "out of memory to fill holes of a picture of %u x %u", plane->width,
							 plane->height);
		pull_push->value_capacity = values;
		pull_push->valid_capacity = valid;
	}
	memcpy(pull_push->valid, plane->valid, (size_t)plane->width * plane->height);
	return 0;
}

static void pull_pixel(const struct level *from, uint32_t channels, uint32_t i, uint32_t j, struct level *to)
{
	float sum[3] = {0.0f, 0.0f, 0.0f};
	uint32_t count = 0, right = i + 1 < from->width ? i + 1 : i, bottom = j + 1 < from->height ? j + 1 : j;
	for (uint32_t y = j; y <= bottom; y++)
		for (uint32_t x = i; x <= right; x++) {
			size_t at = (size_t)y * from->width + x;
			count += from->valid[at];
			for (uint32_t c = 0; from->valid[at] && c < channels; c++)
				sum[c] += from->values[at * channels + c];
		}
	size_t at = (size_t)(j / 2) * to->width + i / 2;
	to->valid[at] = count > 0;
	for (uint32_t c = 0; c < channels; c++)
		to->values[at * channels + c] = count ? sum[c] / (float)count : 0.0f;
}

static void pull(const struct level *from, uint32_t channels, struct level *to)
{
	for (uint32_t j = 0; j < from->height; j += 2)
		for (uint32_t i = 0; i < from->width; i += 2)
			pull_pixel(from, channels, i, j, to);
}

/* The neighbour of weight 1/4 in the level above. */
static uint32_t beside(uint32_t i, uint32_t size)
{
	uint32_t half = i / 2;
	if (i % 2)
		return half + 1 < size ? half + 1 : half;
	return half ? half - 1 : 0;
}

static void push(const struct level *from, uint32_t channels, struct level *to)
{
	for (uint32_t j = 0; j < to->height; j++)
		for (uint32_t i = 0; i < to->width; i++) {
			size_t at = (size_t)j * to->width + i;
			if (to->valid[at])
				continue;
			const float *near = from->values + (size_t)(j / 2) * from->width * channels;
			const float *next = from->values + (size_t)beside(j, from->height) * from->width * channels;
			size_t a = (size_t)(i / 2) * channels, b = (size_t)beside(i, from->width) * channels;
			for (uint32_t c = 0; c < channels; c++)
				to->values[at * channels + c] = 0.75f * (0.75f * near[a + c] + 0.25f * near[b + c]) +
												0.25f * (0.75f * next[a + c] + 0.25f * next[b + c]);
		}
}

int pull_push_fill(struct pull_push *pull_push, const struct pull_push_plane *plane, struct error *error)
{
	struct level levels[PULL_PUSH_LEVELS];
	int result = reserve(pull_push, plane, error);
	if (result < 0)
		return result;
	uint32_t count = make_levels(pull_push, plane, levels);
	for (uint32_t k = 0; k + 1 < count; k++)
		pull(&levels[k], plane->channels, &levels[k + 1]);
	if (!levels[count - 1].valid[0])
		for (uint32_t c = 0; c < plane->channels; c++)
			levels[count - 1].values[c] = 0.0f;
	for (uint32_t k = count - 1; k > 0; k--)
		push(&levels[k], plane->channels, &levels[k - 1]);
	return 0;
}

void pull_push_finish(struct pull_push *pull_push)
{
	free(pull_push->values);
	free(pull_push->valid);
	*pull_push = (struct pull_push){0};
}
