/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The part of a window that GLFW has to do with. All functions are called on the window's thread, and may hang when the
 * display server does.
 */
#ifndef PURSUIT_WINDOW_GLFW_H
#define PURSUIT_WINDOW_GLFW_H

#include <pthread.h>
#include <stdatomic.h>

#include "daemon/present/window.h"
#include "daemon/present/window_thread.h"
#include "daemon/present/x_mode.h"

/* What other threads want. */
struct window_wishes {
	uint32_t width, height; /* window_fit(); 0: none */
	bool toggle;
};

struct window {
	struct window_params params;
	struct presenter_options options; /* without strings */
	struct window_thread *thread;
	char monitor[64]; /* wished for */
	char title[64];
	bool has_turn;        /* with GLFW */
	atomic_bool lost;     /* the display server is gone */
	pthread_mutex_t lock; /* for the wishes */
	struct window_wishes wishes;

	/* GLFW's part */
	struct GLFWwindow *glfw;
	struct GLFWwindow *shared; /* hidden: the context that others draw in; NULL: none */
	Display *display;          /* NULL: not X11 */
	bool glx;
	bool fullscreen;         /* wished for; it may not be while the monitor is unplugged */
	bool is_full;            /* it was made so, and has not been told otherwise */
	bool size_is_free;       /* nobody wished for one */
	bool repeated;           /* the key event before a character was a repetition */
	int x, y, width, height; /* of the window, for the way back from full screen */
	struct x_mode mode;      /* of the monitor, if full screen changed it */
	struct window_state state;
	struct GLFWmonitor *seen_monitor;
	bool seen_full, touched;
	uint32_t polls;
	bool begun, open; /* GLFW is initialised; there is a window */
	struct error error;
};

/* 0 or -ENODEV with a sentence; to be closed in any case. */
int window_glfw_open(struct window *window, struct error *error);
/* Events and wishes; not once it is lost. */
void window_glfw_process(struct window *window);
/* False: the connection broke within, and with it GLFW is of no use any more. */
bool window_glfw_close(struct window *window);

/* ---- the owner is told, unless he does not listen any more (window.c) ---- */

void window_say(struct window *window, const char *format, ...) __attribute__((format(printf, 2, 3)));
void window_tell_key(struct window *window, uint32_t code);
/* Of window->state. */
void window_tell_changed(struct window *window);
/* On any thread: the first time. */
void window_tell_lost(struct window *window);
/* Takes what is wished for. */
struct window_wishes window_take_wishes(struct window *window);

#endif
