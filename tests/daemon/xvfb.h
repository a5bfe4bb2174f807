/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* An X server of one's own without a display (Xvfb), and what a test does to windows there. */
#ifndef PURSUIT_TEST_XVFB_H
#define PURSUIT_TEST_XVFB_H

#include <X11/Xlib.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

struct xvfb {
	pid_t pid;
	char name[16]; /* as DISPLAY, which is set */
	Display *display;
};

/* False: Xvfb is not installed or does not start. Zeroed, or stopped: then it comes back under the name that it had. */
bool xvfb_start(struct xvfb *xvfb);
/* The same with another X server: its program and arguments, NULL-terminated. */
bool xvfb_start_server(struct xvfb *xvfb, const char *const *arguments);
void xvfb_stop(struct xvfb *xvfb);

/* The window with this title, 0 if there is none after 60 s. */
Window xvfb_find(struct xvfb *xvfb, const char *title);
void xvfb_get_size(struct xvfb *xvfb, Window window, unsigned *width, unsigned *height);
/* 0xrrggbb of a pixel of the window as it is on the screen. */
uint32_t xvfb_pixel(struct xvfb *xvfb, Window window, unsigned x, unsigned y);
/* All of its width x height pixels, 0xrrggbb; false: it is not there, or not all of it is on the screen. */
bool xvfb_capture(struct xvfb *xvfb, Window window, unsigned width, unsigned height, uint32_t *pixels);
/* A key pressed and let go: a keysym like "q" or "Escape". */
void xvfb_press(struct xvfb *xvfb, Window window, const char *key);

#endif
