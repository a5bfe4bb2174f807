/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A GL context without a window, with its table of functions. One file a kind;
 * a kind that is not built is a stub that says so.
 */
#ifndef PURSUIT_ENGINE_GL_CONTEXT_H
#define PURSUIT_ENGINE_GL_CONTEXT_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/engine/engine.h"
#include "daemon/engine/gl/gl.h"
#include "daemon/error.h"

struct context;

/* All functions are mandatory and called on the thread that made the context. */
struct context_ops {
	const char *name; /* "egl-surfaceless", "egl-device", "osmesa", "brought" */
	/* Makes it current if it is not; false: it is lost. */
	bool (*enter)(struct context *context);
	/* Leaves no context of this kind current on the thread. */
	void (*release)(struct context *context);
	/* Frees the context, which is current, and the memory. */
	void (*destroy)(struct context *context);
};

/* The head of each kind's own struct. */
struct context {
	const struct context_ops *ops;
	struct gl gl;
	struct engine_info info;
};

/* Makes the context that the params ask for and leaves it current. NULL with a sentence. */
struct context *context_create(const struct engine_params *params, struct error *error);
void context_destroy(struct context **context);

/* Makes it current whatever else was current on this thread. 0, or -EIO with a sentence if it is lost. */
int context_enter(struct context *context, struct error *error);
/* It is current on this thread no more; from now on it is another thread's, or this one's again. */
void context_leave(struct context *context);

/* The kinds, for context.c only. */
struct context *context_egl_surfaceless_create(bool gles, struct error *error);
struct context *context_egl_device_create(uint32_t index, bool gles, struct error *error);
/* The first EGL device that is not a CPU renderer. */
struct context *context_egl_gpu_create(bool gles, struct error *error);
struct context *context_osmesa_create(struct error *error);
/* Refuses what is older than GL 4.3. */
struct context *context_brought_create(const struct engine_context *brought, struct error *error);

#endif
