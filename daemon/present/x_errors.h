/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * An X server that goes away, or refuses something, must not end the process, which is what Xlib does about it. For the
 * whole process.
 */
#ifndef PURSUIT_X_ERRORS_H
#define PURSUIT_X_ERRORS_H

#include <X11/Xlib.h>
#include <stdbool.h>

/* Refusals are ignored from now on, and a broken connection ends nothing. Again after GLFW has made a window. */
void x_errors_survive(void);

/* broken() is called, on any thread, each time somebody finds this connection broken outside x_errors_call(). */
void x_errors_watch(Display *display, XIOErrorExitHandler broken, void *data);

/*
 * Calls what does not expect a connection that breaks: what it asks for has no answer then, and it would go on with
 * what was in memory before. False if that happened: it has been left where it was.
 */
bool x_errors_call(void (*function)(void *data), void *data);

/* Is there a server now? Waits for its answer. */
bool x_errors_can_connect(void);

#endif
