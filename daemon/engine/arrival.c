/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/arrival.h"

#include <errno.h>

#include "daemon/engine/now.h"
#include "daemon/engine/state.h"

struct span {
	uintptr_t from, to;
};

static struct span row_of(const struct arrival *arrival, uint32_t row)
{
	const uintptr_t from = (uintptr_t)arrival->image.data + row * arrival->image.stride;
	return (struct span){from, from + 4 * (uintptr_t)arrival->width};
}

/* Rows lie in memory as in the picture, so those of both are gone through together. */
static bool overlap(const struct arrival *a, const struct arrival *b)
{
	for (uint32_t i = 0, j = 0; i < a->height && j < b->height;) {
		const struct span one = row_of(a, i), other = row_of(b, j);
		if (one.from < other.to && other.from < one.to)
			return true;
		if (one.from < other.from)
			i++;
		else
			j++;
	}
	return false;
}

int arrivals_check(const struct arrivals *arrivals, const struct engine_image *image, uint32_t width, uint32_t height,
				   struct error *error)
{
	const struct arrival next = {.image = *image, .width = width, .height = height};
	if (!image->data)
		return 0;
	if (image->unfinished && arrivals->count == ENGINE_MAX_UNFINISHED)
		return error_set(error, -EBUSY, "%d pictures are unfinished: one must be taken first", ENGINE_MAX_UNFINISHED);
	for (uint32_t i = 0; i < arrivals->count; i++)
		if (overlap(&arrivals->slots[(arrivals->first + i) % ENGINE_MAX_UNFINISHED], &next))
			return error_set(error, -EBUSY,
							 "the image's memory is in part that of an unfinished picture, to be taken first");
	return 0;
}

static int receive(struct engine *engine, struct arrival *arrival, struct error *error)
{
	struct executor *executor = engine->executor;
	if (arrival->lost)
		return error_set(error, -EIO, "the picture is lost: its pixels did not come back");
	if (!arrival->missing)
		return 0;
	const int result = executor->ops->enter(executor, error);
	if (result == 0)
		return executor->ops->receive(executor, arrival, error);
	executor->ops->forget(executor);
	return result;
}

int engine_take(struct engine *engine, struct engine_image *image, struct error *error)
{
	struct arrivals *arrivals = &engine->arrivals;
	const uint64_t began = now_ns();
	*image = (struct engine_image){.data = NULL};
	if (!arrivals->count)
		return error_set(error, -ENOENT, "there is no unfinished picture to take");
	struct arrival *oldest = arrivals_at(arrivals, 0);
	const int result = receive(engine, oldest, error);
	*image = oldest->image;
	if (result < 0)
		image->holds = 0;
	arrivals->first = (arrivals->first + 1) % ENGINE_MAX_UNFINISHED;
	arrivals->count--;
	engine->report.total_ms += (double)(now_ns() - began) * 1e-6;
	return result;
}

void engine_drop(struct engine *engine)
{
	struct executor *executor = engine->executor;
	struct error error;
	uint32_t missing = 0;
	for (uint32_t i = 0; i < engine->arrivals.count; i++)
		missing += arrivals_at(&engine->arrivals, i)->missing;
	if (missing) {
		/* A lost context ignores the calls. */
		executor->ops->enter(executor, &error);
		executor->ops->forget(executor);
	}
	engine->arrivals.count = 0;
}
