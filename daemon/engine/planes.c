/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pass.h"

#include <errno.h>

static int find_plane(const struct pursuit_frame_header *header, uint32_t role)
{
	for (uint32_t i = 0; i < header->plane_count && i < PURSUIT_MAX_PLANES; i++)
		if (header->planes[i].role == role)
			return (int)i;
	return -1;
}

static int check_color(const struct engine *engine, const struct pursuit_frame_header *header, int index,
					   struct error *error)
{
	uint32_t most = engine->executor->max_size;
	if (index < 0)
		return error_set(error, -EINVAL, "frame %llu has no colour plane", (unsigned long long)header->frame_id);
	const struct pursuit_plane *plane = &header->planes[index];
	if (plane->width && plane->height && plane->width <= most && plane->height <= most)
		return 0;
	return error_set(error, -EINVAL, "planes[%d] is %u x %u, this renderer takes 1 x 1 to %u x %u", index, plane->width,
					 plane->height, most, most);
}

int planes_prepare(struct engine *engine, int *color, int *ui, struct error *error)
{
	const struct pursuit_frame_header *header = &engine->job.frame->header;
	const struct engine_params *params = &engine->params;
	*color = find_plane(header, PURSUIT_ROLE_COLOR);
	*ui = find_plane(header, PURSUIT_ROLE_UI);
	int result = check_color(engine, header, *color, error);
	if (result < 0)
		return result;
	const struct pursuit_plane *plane = &header->planes[*color];
	engine->width = plane->width;
	engine->height = plane->height;
	engine->ui_bounds = (struct bounds){0};
	convert_prepare(&engine->color_convert, plane->format, &plane->transfer, params->curve, params->gamma);
	if (*ui < 0)
		return 0;
	const struct pursuit_plane *layer = &header->planes[*ui];
	if (layer->width != plane->width || layer->height != plane->height)
		return error_set(error, -EINVAL, "the UI plane is %u x %u, must be as large as colour, %u x %u", layer->width,
						 layer->height, plane->width, plane->height);
	convert_prepare(&engine->ui_convert, layer->format, NULL, params->curve, params->gamma);
	return 0;
}
