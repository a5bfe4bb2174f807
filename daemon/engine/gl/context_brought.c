/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/context.h"

#include <errno.h>
#include <stdlib.h>

struct context_brought {
	struct context base;
	const struct engine_context *from;
};

static const struct engine_context *from_of(struct context *context)
{
	return ((struct context_brought *)context)->from;
}

static bool brought_enter(struct context *context)
{
	return from_of(context)->enter(from_of(context)->data);
}

static void brought_release(struct context *context)
{
	from_of(context)->release(from_of(context)->data);
}

static void brought_destroy(struct context *context)
{
	brought_release(context);
	free(context);
}

static const struct context_ops brought_ops = {"brought", brought_enter, brought_release, brought_destroy};

static int start(struct context *context, struct error *error)
{
	if (!brought_enter(context))
		return error_set(error, -EIO, "the context that was brought cannot be made current");
	const int result = gl_load(&context->gl, from_of(context)->find, error);
	if (result == 0 && (context->gl.gles || context->gl.version < 43))
		return error_set(error, -ENOTSUP, "the context that was brought is GL %d, must be 4.3 or newer",
						 context->gl.version);
	context->gl.pixel_format = GL_BGRA;
	context->gl.pixel_type = GL_UNSIGNED_INT_8_8_8_8_REV;
	return result;
}

struct context *context_brought_create(const struct engine_context *brought, struct error *error)
{
	struct context_brought *context = calloc(1, sizeof(*context));
	if (!context) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	context->base.ops = &brought_ops;
	context->base.info = (struct engine_info){.context = brought->name, .brought = true};
	context->from = brought;
	if (start(&context->base, error) == 0)
		return &context->base;
	brought_destroy(&context->base);
	return NULL;
}
