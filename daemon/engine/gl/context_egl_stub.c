/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/context.h"

#include <errno.h>

static struct context *refuse(struct error *error)
{
	error_set(error, -ENOTSUP, "built without EGL");
	return NULL;
}

struct context *context_egl_surfaceless_create(bool gles, struct error *error)
{
	return refuse(error);
}

struct context *context_egl_device_create(uint32_t index, bool gles, struct error *error)
{
	return refuse(error);
}

struct context *context_egl_gpu_create(bool gles, struct error *error)
{
	return refuse(error);
}
