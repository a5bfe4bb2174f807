/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Frames of the built-in scenes as a game would hand them in: colour, depth, backward motion and, if asked for, UI. */
#ifndef PURSUIT_REFERENCE_SCENE_FRAME_H
#define PURSUIT_REFERENCE_SCENE_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include "client/scenes/scene.h"
#include "daemon/frame.h"

struct scene_frame {
	struct frame frame;
	uint8_t *memory;
};

/* What is rendered, and how. */
struct scene_moment {
	uint32_t width, height;  /* those of the scene; width a multiple of 16, so that rows are packed as in the scene */
	double time, interval_s; /* seconds; motion is from time - interval_s */
	bool ui;                 /* with the UI layer, where the scene has one */
};

/* Renders and reads; false if it fails. In the scene's context; scene_frame_finish() in any case. */
bool scene_frame_read(struct scene_frame *out, struct scene *scene, const struct scene_moment *moment);
void scene_frame_finish(struct scene_frame *frame);

#endif
