/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A rendered frame in memory, and the size and number of its pixels, for the tests of the scenes. */
#ifndef PURSUIT_TESTS_SCENES_PICTURE_H
#define PURSUIT_TESTS_SCENES_PICTURE_H

#include <stdlib.h>
#include <string.h>

#include "client/scenes/scene.h"

struct picture {
	uint32_t width, height;
	size_t count;
	bool has_ui;
	struct scene_pixels pixels;
	struct scene_camera camera;
};

static inline void picture_init(struct picture *picture, uint32_t width, uint32_t height)
{
	size_t count = (size_t)width * height;
	*picture = (struct picture){.width = width, .height = height, .count = count};
	picture->pixels = (struct scene_pixels){calloc(count, 4), calloc(count, 4), calloc(count, 8),
											calloc(count, 8), calloc(count, 4), calloc(count, 4)};
}

static inline void picture_finish(struct picture *picture)
{
	scene_pixels_finish(&picture->pixels);
}

/* Renders with forward motion and reads everything that the scene has. */
static inline bool picture_take(struct picture *picture, struct scene *scene, double previous, double now, double next)
{
	struct scene_request request = {.time = now, .time_previous = previous, .time_next = next, .forward = true};
	struct scene_textures textures;
	if (!scene_render(scene, &request, &textures, &picture->camera))
		return false;
	struct scene_pixels pixels = picture->pixels;
	picture->has_ui = textures.ui != 0;
	if (!picture->has_ui)
		pixels.ui = NULL;
	return scene_read(scene, &pixels);
}

static inline bool picture_equal(const struct picture *a, const struct picture *b)
{
	return memcmp(a->pixels.color, b->pixels.color, a->count * 4) == 0 &&
		   memcmp(a->pixels.depth, b->pixels.depth, a->count * 4) == 0 &&
		   memcmp(a->pixels.backward, b->pixels.backward, a->count * 8) == 0 &&
		   memcmp(a->pixels.forward, b->pixels.forward, a->count * 8) == 0 &&
		   memcmp(a->pixels.object_id, b->pixels.object_id, a->count * 4) == 0 &&
		   memcmp(a->pixels.ui, b->pixels.ui, a->count * 4) == 0;
}

#endif
