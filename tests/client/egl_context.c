/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/client/egl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <string.h>

static EGLDisplay display;
static EGLContext context;

void *egl_context_lookup(const char *name)
{
	__eglMustCastToProperFunctionPointerType function = eglGetProcAddress(name);
	void *address;

	memcpy(&address, &function, sizeof(address));
	return address;
}

bool egl_context_start(bool es)
{
	const EGLint core[] = {
		EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
		EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
	const EGLint embedded[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};

	display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
	if (!display || !eglInitialize(display, NULL, NULL) || !eglBindAPI(es ? EGL_OPENGL_ES_API : EGL_OPENGL_API)) {
		return false;
	}
	context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, es ? embedded : core);
	return context && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

/* The display stays: terminated, Mesa unloads its driver, and a leak checker can name nothing in it any more. */
void egl_context_finish(void)
{
	if (display) {
		eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
		if (context) {
			eglDestroyContext(display, context);
		}
	}
	display = NULL;
	context = NULL;
}
