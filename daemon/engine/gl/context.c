/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/context.h"

#include <errno.h>
#include <string.h>

/*
 * GL itself knows one current context a thread; EGL and OSMesa each keep a note
 * of their own about it, which the other makes stale. This is the note that both share.
 */
static _Thread_local struct context *entered;

static bool is_software(const char *renderer)
{
	static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "SWR", "SwiftShader", "Software"};
	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
		if (strstr(renderer, names[i]))
			return true;
	return false;
}

static void describe(struct context *context)
{
	const char *renderer = (const char *)context->gl.GetString(GL_RENDERER);
	const char *version = (const char *)context->gl.GetString(GL_VERSION);
	if (!context->info.context)
		context->info.context = context->ops->name;
	context->info.renderer = renderer ? renderer : "unknown";
	context->info.version = version ? version : "unknown";
	context->info.software = is_software(context->info.renderer);
}

static struct context *create_kind(const struct engine_params *params, struct error *error)
{
	switch (params->context) {
	case ENGINE_CONTEXT_AUTO:
		return context_egl_gpu_create(params->gles, error);
	case ENGINE_CONTEXT_EGL_SURFACELESS:
		return context_egl_surfaceless_create(params->gles, error);
	case ENGINE_CONTEXT_EGL_DEVICE:
		return context_egl_device_create(params->device, params->gles, error);
	case ENGINE_CONTEXT_OSMESA:
		if (!params->gles)
			return context_osmesa_create(error);
		error_set(error, -EINVAL, "OSMesa has no OpenGL ES: choose another context");
		return NULL;
	case ENGINE_CONTEXT_CPU:
		break;
	}
	error_set(error, -EINVAL, "context is %d, must be 0 to 4", (int)params->context);
	return NULL;
}

/* The newcomer makes itself current without knowing who was: the one before must let go first. */
static void step_aside(void)
{
	if (entered)
		entered->ops->release(entered);
	entered = NULL;
}

static struct context *take_over(struct context *context)
{
	if (!context)
		return NULL;
	entered = context;
	describe(context);
	return context;
}

/* The one that was brought, if it is what was asked for. */
static struct context *create_brought(const struct engine_params *params)
{
	struct error why_not;
	const bool any = params->context == ENGINE_CONTEXT_EGL_SURFACELESS;
	if (!params->brought || params->gles || (!any && params->context != ENGINE_CONTEXT_AUTO))
		return NULL;
	struct context *context = take_over(context_brought_create(params->brought, &why_not));
	if (context && context->info.software && !any)
		context_destroy(&context);
	return context;
}

struct context *context_create(const struct engine_params *params, struct error *error)
{
	step_aside();
	struct context *context = create_brought(params);
	return context ? context : take_over(create_kind(params, error));
}

int context_enter(struct context *context, struct error *error)
{
	if (entered != context)
		step_aside();
	entered = context;
	if (!context->ops->enter(context))
		return error_set(error, -EIO, "the %s context is lost: it cannot be made current", context->ops->name);
	if (context->gl.GetGraphicsResetStatus && context->gl.GetGraphicsResetStatus() != GL_NO_ERROR)
		return error_set(error, -EIO, "the %s context is lost: the GPU was reset", context->ops->name);
	return 0;
}

void context_leave(struct context *context)
{
	if (entered == context)
		step_aside();
}

void context_destroy(struct context **context)
{
	if (!*context)
		return;
	if (entered == *context)
		entered = NULL;
	(*context)->ops->destroy(*context);
	*context = NULL;
}
