/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A window with a GL context, of the GLFW presenter: the only file behind it
 * includes GLFW, which wants one user a process, always on the same thread. That
 * is main elsewhere; on X11 and Wayland it may be any, so it is one of the
 * window's own (window_thread.h), and a display server that hangs keeps nobody
 * else waiting. Functions of the drawing thread are marked so; that thread has
 * the context.
 */
#ifndef PURSUIT_WINDOW_H
#define PURSUIT_WINDOW_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/error.h"
#include "daemon/present/presenter.h"

struct window;

/* As it is now. */
struct window_state {
	uint32_t width, height; /* of the framebuffer, pixels */
	bool hidden;            /* iconified or without area: nothing drawn there can be seen */
	double refresh_hz;      /* as the monitor's mode says, a whole number mostly; 0 unknown */
	uint32_t changes;       /* rises with each change of the above, and when it needs to be drawn anew */
	uint32_t displays;      /* rises when its vblanks may have become those of another display */
};

struct window_params {
	const struct log *log;
	const struct presenter_options *options; /* valid while it is created */
	double refresh_hz;                       /* wished for, for full screen */
	/* On the window's thread, which no function of this file may be called on. */
	void (*key)(void *data, uint32_t code);
	void (*changed)(void *data, const struct window_state *state);
	/* On any thread, once: the display server is gone. */
	void (*lost)(void *data, const char *sentence);
	void *data;
};

/* ---- any thread ---- */

/* May one be made by now? Asks the display server, if there is one, half a second at most; makes nothing. */
bool window_is_possible(void);
/* Shows an empty window. NULL with a sentence, after a few seconds at most. */
struct window *window_create(const struct window_params *params, struct error *error);
/*
 * After the drawing thread has let the context go, and the other thread that of window_get_context(). Also once it is
 * lost: then another window can be made when there is a server again. Where the server hangs the rest is done when it
 * answers, and until then no other window can be made; what it was created with is not used any more in any case.
 * NULL accepted.
 */
void window_destroy(struct window **window);
/* Nothing that it was created with is used any more, but it cannot be destroyed yet. */
void window_mute(struct window *window);

/* For a window that is left behind: at the process's exit nothing of its libraries is tidied up. */
void window_leave_at_exit(void);

/* For how long the display server has not answered; 0 while it does. */
uint64_t window_silence_ns(const struct window *window);
/* These two are done as soon as it answers. */
void window_toggle_fullscreen(struct window *window);
/* The size of pictures: a window whose size nobody wished for takes it, as far as it fits the monitor. */
void window_fit(struct window *window, uint32_t width, uint32_t height);

/* ---- whoever draws the pictures, on one thread ---- */

/* The context that share_gl of the options asked for, in the share group of the window's. False: there is none. */
bool window_get_context(struct window *window, struct presenter_context *context);

/* ---- the drawing thread ---- */

/* 0 or -EIO with a sentence. */
int window_make_current(struct window *window, struct error *error);
void window_let_go(struct window *window);
/* Shows what was drawn; may wait for the display, long if the window cannot be seen. Nothing once it is lost. */
void window_swap(struct window *window);
typedef void (*window_function)(void);
/* Also for the context of window_get_context(). */
window_function window_find_function(const char *name);
bool window_has_extension(const char *name);
/* The Display and GLXDrawable of the X11 window if its context is one of GLX. False: it is not. */
bool window_get_glx(struct window *window, void **display, unsigned long *drawable);

#endif
