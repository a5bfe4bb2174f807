/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "gl_context.h"

#define MAX_DEVICES 16

struct egl_context {
	EGLDisplay display;
	EGLContext context;
};

static bool has_extension(const char *list, const char *name)
{
	size_t length = strlen(name);
	for (const char *at = list; at && (at = strstr(at, name)); at += length) {
		if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0'))
			return true;
	}
	return false;
}

static bool start_context(EGLDisplay display, struct egl_context *made)
{
	static const EGLint config_wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
	static const EGLint context_wanted[] = {
		EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
		EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
	EGLint count = 0;
	EGLConfig config = NULL;
	if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL))
		return false;
	if (!has_extension(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context"))
		return false;
	if (!eglBindAPI(EGL_OPENGL_API) || !eglChooseConfig(display, config_wanted, &config, 1, &count))
		return false;
	made->display = display;
	made->context = eglCreateContext(display, count > 0 ? config : NULL, EGL_NO_CONTEXT, context_wanted);
	if (made->context == EGL_NO_CONTEXT)
		return false;
	if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, made->context))
		return true;
	eglDestroyContext(display, made->context);
	return false;
}

static bool start_on_gpu(const char *extensions, PFNEGLGETPLATFORMDISPLAYEXTPROC get_display, struct egl_context *made)
{
	if (!has_extension(extensions, "EGL_EXT_platform_device"))
		return false;
	PFNEGLQUERYDEVICESEXTPROC query_devices = (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
	PFNEGLQUERYDEVICESTRINGEXTPROC query_string =
		(PFNEGLQUERYDEVICESTRINGEXTPROC)eglGetProcAddress("eglQueryDeviceStringEXT");
	EGLDeviceEXT devices[MAX_DEVICES];
	EGLint count = 0;
	if (!query_devices || !query_string || !query_devices(MAX_DEVICES, devices, &count))
		return false;
	for (EGLint i = 0; i < count; i++) {
		const char *device = query_string(devices[i], EGL_EXTENSIONS);
		if (!device || has_extension(device, "EGL_MESA_device_software"))
			continue;
		if (start_context(get_display(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL), made))
			return true;
	}
	return false;
}

static void *create(struct error *error)
{
	const char *extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
	PFNEGLGETPLATFORMDISPLAYEXTPROC get_display =
		(PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
	struct egl_context *made = calloc(1, sizeof(*made));
	if (!made || !extensions || !get_display) {
		free(made);
		error_set(error, -ENOTSUP, "EGL here knows no platforms");
		return NULL;
	}
	if (start_on_gpu(extensions, get_display, made))
		return made;
	if (has_extension(extensions, "EGL_MESA_platform_surfaceless") &&
		start_context(get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL), made))
		return made;
	free(made);
	error_set(error, -ENOTSUP, "EGL gave no context: neither on a GPU nor surfaceless (EGL error 0x%x)", eglGetError());
	return NULL;
}

static bool make_current(void *context)
{
	struct egl_context *egl = context;
	eglBindAPI(EGL_OPENGL_API);
	return eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context);
}

static void release(void)
{
	EGLDisplay display = eglGetCurrentDisplay();
	if (display != EGL_NO_DISPLAY)
		eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

/* The display is not terminated: it is the process's, and an engine may have a context on it too. */
static void destroy(void *context)
{
	struct egl_context *egl = context;
	if (eglGetCurrentContext() == egl->context)
		release();
	eglDestroyContext(egl->display, egl->context);
	free(egl);
}

static void *lookup(const char *name)
{
	__eglMustCastToProperFunctionPointerType function = eglGetProcAddress(name);
	void *pointer;
	memcpy(&pointer, &function, sizeof(pointer));
	return pointer;
}

const struct gl_context_kind gl_context_egl = {
	.name = "egl",
	.create = create,
	.make_current = make_current,
	.release = release,
	.destroy = destroy,
	.lookup = lookup,
};
