/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The last picture of a client that has gone, for a presenter or an engine that comes after it. */
#include <stdlib.h>
#include <string.h>

#include "daemon/render.h"

void draw_keep(struct render *render)
{
	const struct engine_request request = {.show = ENGINE_SHOW_PLAIN};
	struct error error;
	uint32_t width, height;
	if (!render->orphan || !render->begun || !render->engine)
		return;
	engine_get_size(render->engine, &width, &height);
	const size_t stride = (size_t)width * 4;
	struct engine_image image = {.data = malloc(stride * height), .stride = stride};
	if (!image.data)
		return;
	if (engine_render(render->engine, &request, &image, &error) < 0) {
		log_warning(render->log, "the last picture cannot be kept: %s", error.text);
		free(image.data);
		return;
	}
	draw_forget_kept(render);
	render->kept.data = image.data;
	render->kept.width = width;
	render->kept.height = height;
}

void draw_forget_kept(struct render *render)
{
	free(render->kept.data);
	render->kept.data = NULL;
}

void draw_kept(struct render *render, uint64_t vblank)
{
	const struct presenter_impl *impl = render->presenter->impl;
	const size_t row = (size_t)render->kept.width * 4;
	struct presenter_image image;
	if (impl->acquire(render->presenter, render->kept.width, render->kept.height, &image) < 0)
		return;
	for (uint32_t y = 0; y < render->kept.height; y++)
		memcpy(image.data + y * image.stride, render->kept.data + y * row, row);
	image.holds = 0;
	view_draw(render, &image);
	render->front_plain = draw_queue(render, &image, vblank, STATS_REPEAT, 0.0) == 0;
	render->front_black &= !render->front_plain;
	if (!render->front_plain)
		impl->release(render->presenter, &image);
}
