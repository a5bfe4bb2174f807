/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A headless GL context to render scenes in: EGL on a GPU, EGL surfaceless,
 * OSMesa, the first that works (GL 3.3 core). Not the engine's own contexts:
 * a scene is a client, and a client's context is its own affair.
 */
#ifndef PURSUIT_CLI_GL_CONTEXT_H
#define PURSUIT_CLI_GL_CONTEXT_H

#include <stdbool.h>

#include "daemon/error.h"

struct gl_context;

/* Functions of one kind of context; a kind that was not built is a stub that says so. */
struct gl_context_kind {
	const char *name;
	/* NULL with a sentence. The new context is current. */
	void *(*create)(struct error *error);
	bool (*make_current)(void *context);
	void (*release)(void); /* no context is current any more */
	void (*destroy)(void *context);
	void *(*lookup)(const char *name); /* of the current context */
};

extern const struct gl_context_kind gl_context_egl;
extern const struct gl_context_kind gl_context_osmesa;

/* Makes a context and makes it current on the calling thread. NULL with a sentence that names all that was tried. */
struct gl_context *gl_context_create(struct error *error);
void gl_context_destroy(struct gl_context **context);

bool gl_context_make_current(struct gl_context *context);
void gl_context_release(struct gl_context *context);

typedef void *(*gl_context_lookup)(const char *name);
gl_context_lookup gl_context_get_lookup(const struct gl_context *context);
const char *gl_context_name(const struct gl_context *context);

/* GL_RENDERER of the context, which is current, "" if unknown; *software: it is one of Mesa's CPU renderers. */
const char *gl_context_renderer(const struct gl_context *context, bool *software);

#endif
