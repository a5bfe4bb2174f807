/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "scene-frame.h"

#include <stdlib.h>

#include "reference.h"

static void add_plane(struct pursuit_frame_header *header, const struct scene_moment *moment, uint32_t role,
					  uint32_t format)
{
	struct pursuit_plane *plane = &header->planes[header->plane_count++];
	plane->role = role;
	plane->format = format;
	plane->width = moment->width;
	plane->height = moment->height;
	if (role == PURSUIT_ROLE_COLOR)
		plane->transfer.curve = PURSUIT_CURVE_SRGB;
}

static void fill_header(struct pursuit_frame_header *header, const struct scene_moment *moment,
						const struct scene_camera *camera, bool ui)
{
	header->frame_id = 1;
	header->real_interval_ns = (uint64_t)(moment->interval_s * 1e9);
	header->motion_kind = PURSUIT_MOTION_BACKWARD;
	header->depth_kind = PURSUIT_DEPTH_DEVICE;
	header->near_distance = camera->near_distance;
	header->far_distance = camera->far_distance;
	add_plane(header, moment, PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_BGRA8);
	add_plane(header, moment, PURSUIT_ROLE_DEPTH, PURSUIT_FORMAT_DEPTH32F);
	add_plane(header, moment, PURSUIT_ROLE_MOTION, PURSUIT_FORMAT_RG32F);
	if (ui)
		add_plane(header, moment, PURSUIT_ROLE_UI, PURSUIT_FORMAT_BGRA8);
}

bool scene_frame_read(struct scene_frame *out, struct scene *scene, const struct scene_moment *moment)
{
	const struct scene_request request = {.time = moment->time,
										  .time_previous = moment->time - moment->interval_s,
										  .time_next = moment->time + moment->interval_s};
	struct pursuit_frame_header *header = &out->frame.header;
	struct scene_textures textures = {0};
	struct scene_camera camera = {0};
	struct error error;
	*out = (struct scene_frame){0};
	if (!scene_render(scene, &request, &textures, &camera))
		return false;
	fill_header(header, moment, &camera, moment->ui && textures.ui != 0);
	const uint64_t bytes = frame_layout(header);
	out->memory = reference_alloc(bytes, 1);
	if (frame_validate(header, bytes, NULL, NULL, &error) != 0)
		return false;
	for (uint32_t i = 0; i < header->plane_count; i++)
		out->frame.planes[i] = out->memory + header->planes[i].offset;
	const struct scene_pixels pixels = {
		.color = out->memory + header->planes[0].offset,
		.depth = (float *)(void *)(out->memory + header->planes[1].offset),
		.backward = (float *)(void *)(out->memory + header->planes[2].offset),
		.ui = header->plane_count > 3 ? out->memory + header->planes[3].offset : NULL,
	};
	return scene_read(scene, &pixels);
}

void scene_frame_finish(struct scene_frame *frame)
{
	free(frame->memory);
	*frame = (struct scene_frame){0};
}
