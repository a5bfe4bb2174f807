/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/daemon/xvfb.h"

#include <X11/Xutil.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/daemon/fixture.h"

#define MAX_ARGUMENTS 24u

static void run_server(const struct xvfb *xvfb, const char *const *arguments, int number_fd)
{
	const int null = open("/dev/null", O_RDWR);
	const char *all[MAX_ARGUMENTS + 4];
	char fd[16];
	size_t count = 0;
	snprintf(fd, sizeof(fd), "%d", number_fd);
	dup2(null, STDOUT_FILENO);
	dup2(null, STDERR_FILENO);
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	for (; arguments[count] && count < MAX_ARGUMENTS; count++)
		all[count] = arguments[count];
	all[count++] = "-displayfd";
	all[count++] = fd;
	all[count++] = xvfb->name;
	all[count] = NULL;
	execvp(all[0], (char *const *)(void *)all);
	_exit(127);
}

static bool start_once(struct xvfb *xvfb, const char *const *arguments)
{
	int ends[2];
	char number[16] = "";
	if (pipe(ends) < 0)
		return false;
	fflush(NULL);
	xvfb->pid = fork();
	if (xvfb->pid == 0)
		run_server(xvfb, arguments, ends[1]);
	close(ends[1]);
	const ssize_t length = read(ends[0], number, sizeof(number) - 1);
	close(ends[0]);
	if (length > 0) {
		number[strcspn(number, "\n")] = 0;
		snprintf(xvfb->name, sizeof(xvfb->name), ":%.14s", number);
		setenv("DISPLAY", xvfb->name, 1);
		xvfb->display = XOpenDisplay(xvfb->name);
	}
	if (!xvfb->display)
		xvfb_stop(xvfb);
	return xvfb->display != NULL;
}

bool xvfb_start_server(struct xvfb *xvfb, const char *const *arguments)
{
	const bool again = *xvfb->name;
	/* A number that no other test has: one that is free while the server is away would go to a test beside this one. */
	if (!again)
		snprintf(xvfb->name, sizeof(xvfb->name), ":%u", 100 + (unsigned)getpid() % 50000);
	bool started = start_once(xvfb, arguments);
	/* What the one before has left may be in the way for a moment. */
	for (int i = 0; again && i < 240 && !started; i++) {
		sleep_ms(250);
		started = start_once(xvfb, arguments);
	}
	return started;
}

bool xvfb_start(struct xvfb *xvfb)
{
	static const char *const arguments[] = {"Xvfb", "-screen", "0", "800x600x24", "-nolisten", "tcp", NULL};
	return xvfb_start_server(xvfb, arguments);
}

void xvfb_stop(struct xvfb *xvfb)
{
	if (xvfb->display)
		XCloseDisplay(xvfb->display);
	xvfb->display = NULL;
	if (xvfb->pid > 0) {
		kill(xvfb->pid, SIGKILL);
		waitpid(xvfb->pid, NULL, 0);
	}
	xvfb->pid = 0;
}

static Window find_once(struct xvfb *xvfb, const char *title)
{
	Window root, parent, *children = NULL, found = 0;
	unsigned count = 0;
	XQueryTree(xvfb->display, DefaultRootWindow(xvfb->display), &root, &parent, &children, &count);
	for (unsigned i = 0; i < count && !found; i++) {
		char *name = NULL;
		if (XFetchName(xvfb->display, children[i], &name) && name && strcmp(name, title) == 0)
			found = children[i];
		if (name)
			XFree(name);
	}
	if (children)
		XFree(children);
	return found;
}

Window xvfb_find(struct xvfb *xvfb, const char *title)
{
	Window window = 0;
	for (int i = 0; xvfb->display && i < 1200 && !window; i++) {
		window = find_once(xvfb, title);
		if (!window)
			sleep_ms(50);
	}
	return window;
}

void xvfb_get_size(struct xvfb *xvfb, Window window, unsigned *width, unsigned *height)
{
	XWindowAttributes attributes = {.width = 0};
	XGetWindowAttributes(xvfb->display, window, &attributes);
	*width = (unsigned)attributes.width;
	*height = (unsigned)attributes.height;
}

static int ignore_error(Display *display, XErrorEvent *event)
{
	(void)display;
	(void)event;
	return 0;
}

uint32_t xvfb_pixel(struct xvfb *xvfb, Window window, unsigned x, unsigned y)
{
	XErrorHandler before = XSetErrorHandler(ignore_error);
	XImage *image = XGetImage(xvfb->display, window, (int)x, (int)y, 1, 1, AllPlanes, ZPixmap);
	const uint32_t pixel = image ? (uint32_t)XGetPixel(image, 0, 0) & 0xffffff : UINT32_MAX;
	if (image)
		XDestroyImage(image);
	XSetErrorHandler(before);
	return pixel;
}

bool xvfb_capture(struct xvfb *xvfb, Window window, unsigned width, unsigned height, uint32_t *pixels)
{
	XErrorHandler before = XSetErrorHandler(ignore_error);
	XImage *image = XGetImage(xvfb->display, window, 0, 0, width, height, AllPlanes, ZPixmap);
	for (unsigned i = 0; image && i < width * height; i++)
		pixels[i] = (uint32_t)XGetPixel(image, (int)(i % width), (int)(i / width)) & 0xffffff;
	if (image)
		XDestroyImage(image);
	XSetErrorHandler(before);
	return image != NULL;
}

void xvfb_press(struct xvfb *xvfb, Window window, const char *key)
{
	XKeyEvent event = {
		.type = KeyPress,
		.display = xvfb->display,
		.window = window,
		.root = DefaultRootWindow(xvfb->display),
		.same_screen = True,
		.time = CurrentTime,
		.keycode = XKeysymToKeycode(xvfb->display, XStringToKeysym(key)),
	};
	XSendEvent(xvfb->display, window, True, KeyPressMask, (XEvent *)&event);
	event.type = KeyRelease;
	XSendEvent(xvfb->display, window, True, KeyReleaseMask, (XEvent *)&event);
	XFlush(xvfb->display);
}
