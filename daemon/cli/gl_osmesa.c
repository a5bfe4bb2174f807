/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* OSMesa is loaded at run time: newer Mesa no longer ships it. Types from its (MIT) header, written out here. */

#include <dlfcn.h>
#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "gl_context.h"

#define OSMESA_FORMAT 0x22
#define OSMESA_RGBA 0x1908
#define OSMESA_PROFILE 0x33
#define OSMESA_CORE_PROFILE 0x34
#define OSMESA_CONTEXT_MAJOR_VERSION 0x36
#define OSMESA_CONTEXT_MINOR_VERSION 0x37
#define GL_TYPE_UNSIGNED_BYTE 0x1401

/* One library, many contexts; the functions are the process's, like those of a linked library. */
static struct {
	void *library;
	void *(*create_context)(const int *attributes, void *share);
	void (*destroy_context)(void *context);
	unsigned char (*make_current)(void *context, void *buffer, unsigned type, int width, int height);
	void *(*get_proc_address)(const char *name);
} osmesa;

struct osmesa_context {
	void *context;
	uint32_t pixel[16]; /* OSMesa wants a buffer; scenes render into textures */
};

static bool load(void)
{
	static const char *const names[] = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
	for (unsigned i = 0; i < 3 && !osmesa.library; i++)
		osmesa.library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL);
	if (!osmesa.library)
		return false;
	struct {
		const char *name;
		void *target;
	} functions[] = {
		{"OSMesaCreateContextAttribs", &osmesa.create_context},
		{"OSMesaDestroyContext", &osmesa.destroy_context},
		{"OSMesaMakeCurrent", &osmesa.make_current},
		{"OSMesaGetProcAddress", &osmesa.get_proc_address},
	};
	for (unsigned i = 0; i < 4; i++) {
		void *function = dlsym(osmesa.library, functions[i].name);
		if (!function)
			return false;
		memcpy(functions[i].target, &function, sizeof(function));
	}
	return true;
}

static bool make_current(void *context)
{
	struct osmesa_context *made = context;
	return osmesa.make_current(made->context, made->pixel, GL_TYPE_UNSIGNED_BYTE, 4, 4);
}

static void release(void)
{
	osmesa.make_current(NULL, NULL, 0, 0, 0);
}

static void destroy(void *context)
{
	struct osmesa_context *made = context;
	osmesa.destroy_context(made->context);
	free(made);
}

static void *create(struct error *error)
{
	static const int wanted[] = {OSMESA_FORMAT,
								 OSMESA_RGBA,
								 OSMESA_PROFILE,
								 OSMESA_CORE_PROFILE,
								 OSMESA_CONTEXT_MAJOR_VERSION,
								 3,
								 OSMESA_CONTEXT_MINOR_VERSION,
								 3,
								 0};
	struct osmesa_context *made = calloc(1, sizeof(*made));
	if (!made || !load()) {
		free(made);
		error_set(error, -ENOTSUP, "OSMesa is not installed");
		return NULL;
	}
	made->context = osmesa.create_context(wanted, NULL);
	if (made->context && make_current(made))
		return made;
	if (made->context)
		osmesa.destroy_context(made->context);
	free(made);
	error_set(error, -ENOTSUP, "OSMesa gave no GL 3.3 context");
	return NULL;
}

static void *lookup(const char *name)
{
	return osmesa.get_proc_address(name);
}

const struct gl_context_kind gl_context_osmesa = {
	.name = "osmesa",
	.create = create,
	.make_current = make_current,
	.release = release,
	.destroy = destroy,
	.lookup = lookup,
};
