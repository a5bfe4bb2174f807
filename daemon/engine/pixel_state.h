/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What methods that work pixel by pixel keep in memory of the last two real frames. They run on the CPU with every
 * executor; what they make is handed over as a whole (PASS_PUT).
 */
#ifndef PURSUIT_ENGINE_PIXEL_STATE_H
#define PURSUIT_ENGINE_PIXEL_STATE_H

#include <stdbool.h>

#include "daemon/engine/pixels/scatter.h"

/* One real frame. */
struct pixel_frame {
	struct plan_dense dense;
	struct bitmap bitmap; /* the original, code values of the display */
	size_t bytes;
};

/* Zeroed: there is no frame. */
struct pixel_state {
	struct pixel_frame frames[2];
	uint32_t now;        /* index of the frame begun last */
	uint32_t count;      /* frames that are known and of one size, 0 to 2 */
	struct bitmap shown; /* what is painted */
	size_t shown_bytes;
	struct scatter scatter;
};

static inline const struct pixel_frame *pixel_state_now(const struct pixel_state *state)
{
	return &state->frames[state->now];
}

/* NULL: there was none before, or of another size. */
static inline const struct pixel_frame *pixel_state_before(const struct pixel_state *state)
{
	return state->count > 1 ? &state->frames[1 - state->now] : NULL;
}

/* Makes the bitmap that large; what is in it is undefined afterwards. False if memory is out. */
bool bitmap_resize(struct bitmap *bitmap, size_t *bytes, uint32_t width, uint32_t height);

/* What comes next has nothing to do with what was before. */
void pixel_state_forget(struct pixel_state *state);
/* Memory that it holds. */
uint64_t pixel_state_bytes(const struct pixel_state *state);
void pixel_state_finish(struct pixel_state *state);

#endif
