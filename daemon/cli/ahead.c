/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "ahead.h"

static int take(struct ahead *ahead, struct error *error)
{
	struct engine_image image;
	ahead->count--;
	return engine_take(ahead->engine, &image, error);
}

int ahead_render(struct ahead *ahead, const struct engine_request *request, uint8_t *data, size_t stride,
				 struct error *error)
{
	struct engine_image image = {.data = data, .stride = stride, .unfinished = true};
	int result = ahead->count == ENGINE_MAX_UNFINISHED ? take(ahead, error) : 0;
	if (result == 0)
		result = engine_render(ahead->engine, request, &image, error);
	ahead->count += result == 0;
	return result;
}

int ahead_finish(struct ahead *ahead, int result, struct error *error)
{
	while (ahead->count && result == 0)
		result = take(ahead, error);
	if (result < 0)
		engine_drop(ahead->engine);
	ahead->count = 0;
	return result;
}
