/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pixel_state.h"

#include <stdlib.h>

bool bitmap_resize(struct bitmap *bitmap, size_t *bytes, uint32_t width, uint32_t height)
{
	const size_t needed = 4 * (size_t)width * height;
	if (needed > *bytes) {
		free(bitmap->data);
		bitmap->data = malloc(needed);
		*bytes = bitmap->data ? needed : 0;
	}
	const bool there = bitmap->data != NULL;
	bitmap->width = there ? width : 0;
	bitmap->height = there ? height : 0;
	return there;
}

void pixel_state_forget(struct pixel_state *state)
{
	state->count = 0;
}

uint64_t pixel_state_bytes(const struct pixel_state *state)
{
	const struct scatter *scatter = &state->scatter;
	uint64_t bytes = state->shown_bytes + scatter->fill.value_capacity * sizeof(*scatter->fill.values) +
					 scatter->fill.valid_capacity;
	bytes += scatter->capacity * (uint64_t)(sizeof(*scatter->source) + 3 * sizeof(*scatter->values) + 1);
	for (int i = 0; i < 2; i++)
		bytes += state->frames[i].bytes + plan_dense_bytes(&state->frames[i].dense);
	return bytes;
}

void pixel_state_finish(struct pixel_state *state)
{
	for (int i = 0; i < 2; i++) {
		plan_dense_finish(&state->frames[i].dense);
		free(state->frames[i].bitmap.data);
	}
	free(state->shown.data);
	scatter_finish(&state->scatter);
	*state = (struct pixel_state){0};
}
