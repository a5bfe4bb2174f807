/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A GL context without a window or a surface, for tests and benchmarks. */
#ifndef PURSUIT_EGL_CONTEXT_H
#define PURSUIT_EGL_CONTEXT_H

#include <stdbool.h>

/* Makes a context current: GL 3.3 core, or GLES 3.0 or later. False if this machine has none. */
bool egl_context_start(bool es);
void egl_context_finish(void);

/* eglGetProcAddress with the type that pursuit_gl_create() takes. */
void *egl_context_lookup(const char *name);

#endif
