/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* OSMesa is loaded at run time, since newer Mesa no longer ships it. */
#include "daemon/engine/gl/context.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>

/* GL/osmesa.h, which goes the same way as the library. */
typedef struct osmesa_context *OSMesaContext;
#define OSMESA_FORMAT 0x22
#define OSMESA_PROFILE 0x33
#define OSMESA_CORE_PROFILE 0x34
#define OSMESA_CONTEXT_MAJOR_VERSION 0x36
#define OSMESA_CONTEXT_MINOR_VERSION 0x37
#define OSMESA_BGRA 0x1
/* The buffer that OSMesa insists on; the engine draws into textures only. */
#define BUFFER_SIZE 8

struct context_osmesa {
	struct context base;
	void *library;
	OSMesaContext context;
	OSMesaContext (*create)(const int *attributes, OSMesaContext share);
	void (*destroy)(OSMesaContext context);
	GLboolean (*make_current)(OSMesaContext context, void *buffer, GLenum type, GLsizei width, GLsizei height);
	OSMesaContext (*get_current)(void);
	gl_lookup lookup;
	uint32_t buffer[BUFFER_SIZE * BUFFER_SIZE];
};

static struct context_osmesa *self(struct context *context)
{
	return (struct context_osmesa *)context;
}

static bool make_current(struct context_osmesa *osmesa)
{
	return osmesa->make_current(osmesa->context, osmesa->buffer, GL_UNSIGNED_BYTE, BUFFER_SIZE, BUFFER_SIZE);
}

static bool osmesa_enter(struct context *context)
{
	return self(context)->get_current() == self(context)->context || make_current(self(context));
}

static void osmesa_release(struct context *context)
{
	self(context)->make_current(NULL, NULL, GL_UNSIGNED_BYTE, 0, 0);
}

static void osmesa_destroy(struct context *context)
{
	struct context_osmesa *osmesa = self(context);
	osmesa_release(context);
	osmesa->destroy(osmesa->context);
	dlclose(osmesa->library);
	free(osmesa);
}

static const struct context_ops osmesa_ops = {"osmesa", osmesa_enter, osmesa_release, osmesa_destroy};

/* It stays in memory when closed: Mesa leaves thread-local destructors behind. */
static void *open_library(void)
{
	static const char *const names[] = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
	void *library = NULL;
	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]) && !library; i++)
		library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
	return library;
}

static bool find_functions(struct context_osmesa *osmesa)
{
	*(void **)&osmesa->create = dlsym(osmesa->library, "OSMesaCreateContextAttribs");
	*(void **)&osmesa->destroy = dlsym(osmesa->library, "OSMesaDestroyContext");
	*(void **)&osmesa->make_current = dlsym(osmesa->library, "OSMesaMakeCurrent");
	*(void **)&osmesa->get_current = dlsym(osmesa->library, "OSMesaGetCurrentContext");
	*(void **)&osmesa->lookup = dlsym(osmesa->library, "OSMesaGetProcAddress");
	return osmesa->create && osmesa->destroy && osmesa->make_current && osmesa->get_current && osmesa->lookup;
}

static OSMesaContext create_newest(const struct context_osmesa *osmesa)
{
	static const int versions[] = {43, 41, 33};
	OSMesaContext context = NULL;
	for (size_t i = 0; i < sizeof(versions) / sizeof(versions[0]) && !context; i++) {
		const int attributes[] = {OSMESA_FORMAT,
								  OSMESA_BGRA,
								  OSMESA_PROFILE,
								  OSMESA_CORE_PROFILE,
								  OSMESA_CONTEXT_MAJOR_VERSION,
								  versions[i] / 10,
								  OSMESA_CONTEXT_MINOR_VERSION,
								  versions[i] % 10,
								  0};
		context = osmesa->create(attributes, NULL);
	}
	return context;
}

static bool start(struct context_osmesa *osmesa, struct error *error)
{
	osmesa->library = open_library();
	if (!osmesa->library) {
		error_set(error, -ENODEV, "libOSMesa.so.8 cannot be loaded (Debian 12: install libosmesa6)");
		return false;
	}
	if (!find_functions(osmesa)) {
		error_set(error, -ENOTSUP, "libOSMesa is too old: OSMesaCreateContextAttribs is missing");
		return false;
	}
	osmesa->context = create_newest(osmesa);
	if (!osmesa->context || !make_current(osmesa)) {
		error_set(error, -ENOTSUP, "libOSMesa gives no OpenGL 3.3 core context");
		return false;
	}
	return gl_load(&osmesa->base.gl, osmesa->lookup, error) == 0;
}

struct context *context_osmesa_create(struct error *error)
{
	struct context_osmesa *osmesa = calloc(1, sizeof(*osmesa));
	if (!osmesa) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	osmesa->base.ops = &osmesa_ops;
	if (start(osmesa, error))
		return &osmesa->base;
	if (osmesa->context) {
		osmesa_release(&osmesa->base);
		osmesa->destroy(osmesa->context);
	}
	if (osmesa->library)
		dlclose(osmesa->library);
	free(osmesa);
	return NULL;
}
