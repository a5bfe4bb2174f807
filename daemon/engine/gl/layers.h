/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * ORIGINAL, REAL and BETWEEN, which differ only where there is a blur weight: one texture, that of ORIGINAL, in which
 * these tiles are drawn anew when another of the three is wanted, from a copy of what they are in ORIGINAL. So nothing
 * is copied or drawn where there is no weight.
 */
#ifndef PURSUIT_ENGINE_GL_LAYERS_H
#define PURSUIT_ENGINE_GL_LAYERS_H

#include "daemon/engine/executor.h"
#include "daemon/engine/gl/target.h"
#include "daemon/engine/gl/tile_buffer.h"
#include "daemon/engine/gl/warp_buffers.h"

/* A zeroed one is ready for use. */
struct gl_layers {
	bool made;             /* there are REAL and BETWEEN of the frame begun last */
	enum picture_id shown; /* what the texture holds, if they are made */
	struct target kept;    /* ORIGINAL, where the others differ from it */
	struct tile_buffer tiles;
	/* What they are made with, as it was when the frame began: vertices and settings change before they are asked for.
	 */
	struct warp_kept triangles; /* with a blur weight */
	unsigned variant;           /* of the program */
	bool real_differs;
	uint32_t level; /* of the pyramid */
	float last_phase, count, boost, gamma;
};

/* All three are what the texture holds from now on: a frame is about to be taken as a whole. */
void gl_layers_forget(struct gl_layers *layers);
void gl_layers_finish(struct gl_layers *layers, const struct gl *gl);

/* Of GL's memory. */
uint64_t gl_layers_bytes(const struct gl_layers *layers);

#endif
