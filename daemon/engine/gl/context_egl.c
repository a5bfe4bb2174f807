/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/context.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

struct context_egl {
	struct context base;
	EGLDisplay display;
	EGLContext context;
};

static struct context_egl *self(struct context *context)
{
	return (struct context_egl *)context;
}

static bool egl_enter(struct context *context)
{
	struct context_egl *egl = self(context);
	if (eglGetCurrentContext() == egl->context)
		return true;
	return eglBindAPI(context->gl.gles ? EGL_OPENGL_ES_API : EGL_OPENGL_API) &&
		   eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context);
}

static void egl_release(struct context *context)
{
	eglMakeCurrent(self(context)->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

/* The display stays initialised: it is shared with everybody in the process who uses EGL. */
static void egl_destroy(struct context *context)
{
	struct context_egl *egl = self(context);
	egl_release(context);
	eglDestroyContext(egl->display, egl->context);
	free(egl);
}

static const struct context_ops surfaceless_ops = {"egl-surfaceless", egl_enter, egl_release, egl_destroy};
static const struct context_ops device_ops = {"egl-device", egl_enter, egl_release, egl_destroy};

/* Whole words only: one name may be the beginning of another. */
static bool listed(const char *extensions, const char *name)
{
	size_t length = strlen(name);
	for (const char *at = extensions; at && (at = strstr(at, name)); at += length)
		if ((at == extensions || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0'))
			return true;
	return false;
}

static EGLConfig choose_config(EGLDisplay display, bool gles)
{
	if (listed(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_no_config_context"))
		return EGL_NO_CONFIG_KHR;
	const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, gles ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT,
							 EGL_NONE};
	EGLConfig config = EGL_NO_CONFIG_KHR;
	EGLint count = 0;
	eglChooseConfig(display, wanted, &config, 1, &count);
	return config;
}

static EGLContext create_context(EGLDisplay display, EGLConfig config, bool gles, bool robust)
{
	EGLint attributes[16] = {EGL_CONTEXT_MAJOR_VERSION, gles ? 3 : 4, EGL_CONTEXT_MINOR_VERSION, gles ? 1 : 3};
	int used = 4;
	if (!gles) {
		attributes[used++] = EGL_CONTEXT_OPENGL_PROFILE_MASK;
		attributes[used++] = EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT;
	}
	if (robust) {
		attributes[used++] =
			gles ? EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT : EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY;
		attributes[used++] = EGL_LOSE_CONTEXT_ON_RESET;
	}
	attributes[used] = EGL_NONE;
	return eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
}

static gl_function lookup(const char *name)
{
	return eglGetProcAddress(name);
}

/* The context of a context_egl whose display is initialised; current when it returns true. */
static bool start(struct context_egl *egl, bool gles, struct error *error)
{
	const char *extensions = eglQueryString(egl->display, EGL_EXTENSIONS);
	if (!listed(extensions, "EGL_KHR_surfaceless_context")) {
		error_set(error, -ENOTSUP, "EGL lacks EGL_KHR_surfaceless_context");
		return false;
	}
	if (!eglBindAPI(gles ? EGL_OPENGL_ES_API : EGL_OPENGL_API)) {
		error_set(error, -ENOTSUP, "EGL has no %s", gles ? "OpenGL ES" : "OpenGL");
		return false;
	}
	EGLConfig config = choose_config(egl->display, gles);
	egl->context = create_context(egl->display, config, gles, true);
	if (egl->context == EGL_NO_CONTEXT)
		egl->context = create_context(egl->display, config, gles, false);
	if (egl->context == EGL_NO_CONTEXT) {
		error_set(error, -ENOTSUP, "EGL gives no %s context (error 0x%x)", gles ? "OpenGL ES 3.1" : "OpenGL 4.3 core",
				  (unsigned)eglGetError());
		return false;
	}
	if (!eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context)) {
		error_set(error, -EIO, "the EGL context cannot be made current (error 0x%x)", (unsigned)eglGetError());
		return false;
	}
	return gl_load(&egl->base.gl, lookup, error) == 0;
}

static struct context *create(EGLenum platform, void *native, const struct context_ops *ops, bool gles,
							  struct error *error)
{
	PFNEGLGETPLATFORMDISPLAYEXTPROC get_display =
		(PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
	EGLDisplay display = get_display ? get_display(platform, native, NULL) : EGL_NO_DISPLAY;
	if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL)) {
		error_set(error, -ENODEV, "EGL cannot be initialised (error 0x%x)", (unsigned)eglGetError());
		return NULL;
	}
	struct context_egl *egl = calloc(1, sizeof(*egl));
	if (!egl) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	egl->base.ops = ops;
	egl->display = display;
	egl->context = EGL_NO_CONTEXT;
	if (start(egl, gles, error))
		return &egl->base;
	egl_release(&egl->base);
	if (egl->context != EGL_NO_CONTEXT)
		eglDestroyContext(display, egl->context);
	free(egl);
	return NULL;
}

struct context *context_egl_surfaceless_create(bool gles, struct error *error)
{
	if (!listed(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_MESA_platform_surfaceless")) {
		error_set(error, -ENOTSUP, "EGL lacks EGL_MESA_platform_surfaceless");
		return NULL;
	}
	return create(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, &surfaceless_ops, gles, error);
}

#define MAX_DEVICES 32

/* How many devices there are; -1 with a sentence if EGL cannot tell. */
static int list_devices(EGLDeviceEXT devices[MAX_DEVICES], struct error *error)
{
	const char *extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
	PFNEGLQUERYDEVICESEXTPROC query = (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
	EGLint count = 0;
	if (!query || !listed(extensions, "EGL_EXT_platform_device") || !query(MAX_DEVICES, devices, &count)) {
		error_set(error, -ENOTSUP, "EGL lacks EGL_EXT_platform_device");
		return -1;
	}
	return (int)count;
}

struct context *context_egl_device_create(uint32_t index, bool gles, struct error *error)
{
	EGLDeviceEXT devices[MAX_DEVICES];
	int count = list_devices(devices, error);
	if (count < 0)
		return NULL;
	if (index >= (uint32_t)count) {
		error_set(error, -EINVAL, "device is %u, but EGL knows %d", index, count);
		return NULL;
	}
	return create(EGL_PLATFORM_DEVICE_EXT, devices[index], &device_ops, gles, error);
}

struct context *context_egl_gpu_create(bool gles, struct error *error)
{
	PFNEGLQUERYDEVICESTRINGEXTPROC query = (PFNEGLQUERYDEVICESTRINGEXTPROC)eglGetProcAddress("eglQueryDeviceStringEXT");
	EGLDeviceEXT devices[MAX_DEVICES];
	int count = list_devices(devices, error);
	if (count < 0)
		return NULL;
	error_set(error, -ENODEV, "no device that is not software");
	for (int i = 0; i < count && query; i++) {
		if (listed(query(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software"))
			continue;
		struct context *context = create(EGL_PLATFORM_DEVICE_EXT, devices[i], &device_ops, gles, error);
		if (context)
			return context;
	}
	return NULL;
}
