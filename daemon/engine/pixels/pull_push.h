/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Holes of a plane filled from what is around them (docs/method.md, 9.5; Mark et al. 2007). */
#ifndef PURSUIT_PIXELS_PULL_PUSH_H
#define PURSUIT_PIXELS_PULL_PUSH_H

#include <stddef.h>
#include <stdint.h>

#include "daemon/error.h"

#define PULL_PUSH_LEVELS 32

/* Memory that is kept from call to call; zeroed at first. */
struct pull_push {
	float *values;
	uint8_t *valid;
	size_t value_capacity, valid_capacity;
};

/* Numbers in rows from the top, `channels` (1 to 3) a pixel. */
struct pull_push_plane {
	uint32_t width, height, channels;
	float *values;
	const uint8_t *valid; /* a byte a pixel, 0: hole */
};

/* Fills the holes in place; all of it is 0 if nothing is valid. 0 or -ENOMEM with a sentence. */
int pull_push_fill(struct pull_push *pull_push, const struct pull_push_plane *plane, struct error *error);
void pull_push_finish(struct pull_push *pull_push);

#endif
