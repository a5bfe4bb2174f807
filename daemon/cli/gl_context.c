/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "gl_context.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define NAME_OF_RENDERER 0x1F01u /* GL_RENDERER */

struct gl_context {
	const struct gl_context_kind *kind;
	void *context;
};

struct gl_context *gl_context_create(struct error *error)
{
	const struct gl_context_kind *const kinds[] = {&gl_context_egl, &gl_context_osmesa};
	struct error why[2] = {{{0}}, {{0}}};
	struct gl_context *made = calloc(1, sizeof(*made));
	if (!made) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	for (unsigned i = 0; i < 2; i++) {
		made->kind = kinds[i];
		made->context = kinds[i]->create(&why[i]);
		if (made->context)
			return made;
	}
	free(made);
	error_set(error, -ENOTSUP,
			  "no GL context to render a scene in (%.150s; %.150s). Install Mesa: on Debian and Ubuntu "
			  "`apt install libegl1 libgl1-mesa-dri`",
			  why[0].text, why[1].text);
	return NULL;
}

void gl_context_destroy(struct gl_context **context)
{
	if (!context || !*context)
		return;
	(*context)->kind->destroy((*context)->context);
	free(*context);
	*context = NULL;
}

bool gl_context_make_current(struct gl_context *context)
{
	return context->kind->make_current(context->context);
}

void gl_context_release(struct gl_context *context)
{
	context->kind->release();
}

gl_context_lookup gl_context_get_lookup(const struct gl_context *context)
{
	return context->kind->lookup;
}

const char *gl_context_name(const struct gl_context *context)
{
	return context->kind->name;
}

const char *gl_context_renderer(const struct gl_context *context, bool *software)
{
	void *found = context->kind->lookup("glGetString");
	const unsigned char *(*get_string)(unsigned name);
	memcpy(&get_string, &found, sizeof(found));
	const char *name = found ? (const char *)get_string(NAME_OF_RENDERER) : NULL;
	name = name ? name : "";
	*software = strstr(name, "llvmpipe") || strstr(name, "softpipe") || strstr(name, "swrast");
	return name;
}
