/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/x_errors.h"

#include <setjmp.h>
#include <stddef.h>

/* Xlib knows handlers of the process only; so this is where the thread that it calls one on goes. */
static _Thread_local jmp_buf *way_out;

/*
 * Xlib has locked the display for this thread for ever, so that others would wait for ever; without the lock they find
 * the connection broken by themselves, and their calls do nothing.
 */
static int on_io_error(Display *display)
{
	XUnlockDisplay(display);
	if (way_out)
		longjmp(*way_out, 1);
	return 0;
}

/* Like a monitor that was unplugged under full screen, whose mode GLFW wants to put back. */
static int on_error(Display *display, XErrorEvent *event)
{
	(void)display;
	(void)event;
	return 0;
}

void x_errors_survive(void)
{
	XSetIOErrorHandler(on_io_error);
	XSetErrorHandler(on_error);
}

void x_errors_watch(Display *display, XIOErrorExitHandler broken, void *data)
{
	XSetIOErrorExitHandler(display, broken, data);
}

bool x_errors_call(void (*function)(void *data), void *data)
{
	jmp_buf here;
	const bool fine = setjmp(here) == 0;
	if (fine) {
		way_out = &here;
		function(data);
	}
	way_out = NULL;
	return fine;
}

bool x_errors_can_connect(void)
{
	XInitThreads();
	Display *display = XOpenDisplay(NULL);
	if (display)
		XCloseDisplay(display);
	return display != NULL;
}
