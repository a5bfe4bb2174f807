/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Displayed frames on their way to the caller's memory: engine_render() asks for them, engine_take() gives them. */
#ifndef PURSUIT_ENGINE_ARRIVAL_H
#define PURSUIT_ENGINE_ARRIVAL_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/engine/engine.h"

struct arrival {
	struct engine_image image; /* as it will be given */
	uint32_t width, height;    /* pixels */
	uint32_t missing;          /* blocks of rows that the executor has under way; 0: it is there, or lost */
	bool lost;                 /* the executor's: some never came */
};

/* The oldest first. Executors point to what is missing in them: they stay where they are. */
struct arrivals {
	struct arrival slots[ENGINE_MAX_UNFINISHED];
	uint32_t first, count;
};

static inline struct arrival *arrivals_at(struct arrivals *arrivals, uint32_t index)
{
	return &arrivals->slots[(arrivals->first + index) % ENGINE_MAX_UNFINISHED];
}

/* Where the next one goes; it is one of them once it is counted. */
static inline struct arrival *arrivals_next(struct arrivals *arrivals)
{
	return arrivals_at(arrivals, arrivals->count);
}

/*
 * May a picture of that size be drawn to the image? 0, or -EBUSY with a sentence: there is no room for it, or a pixel
 * of one of them lies where one of its does. What is between the rows is nobody's.
 */
int arrivals_check(const struct arrivals *arrivals, const struct engine_image *image, uint32_t width, uint32_t height,
				   struct error *error);

#endif
