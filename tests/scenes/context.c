/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdio.h>

static bool fail(struct test_context *context, const char *what)
{
	printf("EGL surfaceless: %s failed with 0x%x\n", what, (unsigned)eglGetError());
	test_context_finish(context);
	return false;
}

bool test_context_init(struct test_context *context, bool es)
{
	*context = (struct test_context){0};
	EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
	if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL))
		return fail(context, "eglInitialize");
	context->display = display;
	if (!eglBindAPI(es ? EGL_OPENGL_ES_API : EGL_OPENGL_API))
		return fail(context, "eglBindAPI");
	const EGLint gl_attributes[] = {
		EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
		EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
	const EGLint es_attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 1, EGL_NONE};
	context->context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, es ? es_attributes : gl_attributes);
	if (context->context == EGL_NO_CONTEXT)
		return fail(context, "eglCreateContext");
	if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context->context))
		return fail(context, "eglMakeCurrent");
	return true;
}

void test_context_finish(struct test_context *context)
{
	if (context->display) {
		eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
		if (context->context)
			eglDestroyContext(context->display, context->context);
		/* No eglTerminate: it unloads the driver, and then its own leaks could not be named in lsan.supp. */
	}
	*context = (struct test_context){0};
}

void *test_context_lookup(const char *name)
{
	union {
		void (*function)(void);
		void *object;
	} pointer = {.function = eglGetProcAddress(name)};
	return pointer.object;
}
