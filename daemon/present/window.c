/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "daemon/present/window_glfw.h"
#include "daemon/present/x_errors.h"

#define SECOND UINT64_C(1000000000)
#define ASK_NS (SECOND / 2)
#define ASK_FIRST_NS (2 * SECOND)
#define OPEN_NS (5 * SECOND)

/* GLFW has one user a process, and who asks a server that hangs should not be many: the thread that has this. */
static pthread_mutex_t turn = PTHREAD_MUTEX_INITIALIZER;

static int take_turn(struct error *error)
{
	return pthread_mutex_trylock(&turn) == 0 ? 0
											 : error_set(error, -ETIMEDOUT, "glfw: the display server does not answer");
}

/* ---- what its owner is told ---- */

void window_say(struct window *window, const char *format, ...)
{
	char text[256];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof(text), format, arguments);
	va_end(arguments);
	if (window_thread_begin_call(window->thread)) {
		log_info(window->params.log, "%s", text);
		window_thread_end_call(window->thread);
	}
}

void window_tell_key(struct window *window, uint32_t code)
{
	if (window_thread_begin_call(window->thread)) {
		window->params.key(window->params.data, code);
		window_thread_end_call(window->thread);
	}
}

void window_tell_changed(struct window *window)
{
	if (window_thread_begin_call(window->thread)) {
		window->params.changed(window->params.data, &window->state);
		window_thread_end_call(window->thread);
	}
}

void window_tell_lost(struct window *window)
{
	if (atomic_exchange(&window->lost, true) || !window_thread_begin_call(window->thread))
		return;
	window->params.lost(window->params.data, "glfw: the connection to the X server broke");
	window_thread_end_call(window->thread);
}

struct window_wishes window_take_wishes(struct window *window)
{
	pthread_mutex_lock(&window->lock);
	const struct window_wishes wishes = window->wishes;
	window->wishes = (struct window_wishes){0};
	pthread_mutex_unlock(&window->lock);
	return wishes;
}

/* ---- the thread's work ---- */

static int open_window(void *data, struct window_thread *thread, struct error *error)
{
	struct window *window = data;
	window->thread = thread;
	window->has_turn = take_turn(error) == 0;
	return window->has_turn ? window_glfw_open(window, error) : -ETIMEDOUT;
}

static int get_fd(void *data)
{
	const struct window *window = data;
	return window->display ? ConnectionNumber(window->display) : -1;
}

static bool process(void *data)
{
	struct window *window = data;
	if (!atomic_load(&window->lost))
		window_glfw_process(window);
	return !atomic_load(&window->lost);
}

static void close_window(void *data)
{
	struct window *window = data;
	/* libGLX would tidy up a connection that nobody may touch any more. */
	if (!window_glfw_close(window))
		window_thread_leave_at_exit();
	if (window->has_turn)
		pthread_mutex_unlock(&turn);
}

static void release_window(void *data)
{
	struct window *window = data;
	pthread_mutex_destroy(&window->lock);
	free(window);
}

/* ---- is there a server, and does it answer? ---- */

static int open_question(void *data, struct window_thread *thread, struct error *error)
{
	bool *has_turn = data;
	(void)thread;
	*has_turn = take_turn(error) == 0;
	if (!*has_turn)
		return -ETIMEDOUT;
	return x_errors_can_connect() ? 0 : error_set(error, -ENODEV, "glfw: no X server");
}

static int get_no_fd(void *data)
{
	(void)data;
	return -1;
}

static bool process_nothing(void *data)
{
	(void)data;
	return false;
}

static void close_question(void *data)
{
	const bool *has_turn = data;
	if (*has_turn)
		pthread_mutex_unlock(&turn);
}

/* 0; -ENODEV: there is none; -ETIMEDOUT: it does not answer. */
static int ask(uint64_t limit_ns, struct error *error)
{
	bool *has_turn = calloc(1, sizeof(*has_turn));
	const struct window_work work = {open_question, get_no_fd, process_nothing, close_question, free, has_turn};
	struct window_thread *thread = NULL;
	const int result = has_turn ? window_thread_start(&work, limit_ns, &thread, error) : -ENOMEM;
	window_thread_stop(&thread);
	return result;
}

bool window_is_possible(void)
{
	struct error error;
	return ask(ASK_NS, &error) == 0;
}

/* ---- its owner ---- */

static struct window *allocate(const struct window_params *params)
{
	struct window *window = calloc(1, sizeof(*window));
	const struct presenter_options *options = params->options;
	if (!window)
		return NULL;
	window->params = *params;
	window->params.options = NULL;
	window->options = *options;
	window->fullscreen = options->fullscreen;
	window->size_is_free = options->width == 0;
	snprintf(window->monitor, sizeof(window->monitor), "%s", options->monitor ? options->monitor : "");
	snprintf(window->title, sizeof(window->title), "%s", options->title ? options->title : "Pursuit");
	pthread_mutex_init(&window->lock, NULL);
	return window;
}

struct window *window_create(const struct window_params *params, struct error *error)
{
	/* Without an X server there may be another one, which GLFW knows. */
	if (ask(ASK_FIRST_NS, error) == -ETIMEDOUT)
		return NULL;
	struct window *window = allocate(params);
	if (!window) {
		error_set(error, -ENOMEM, "glfw: out of memory");
		return NULL;
	}
	const struct window_work work = {open_window, get_fd, process, close_window, release_window, window};
	struct window_thread *thread;
	return window_thread_start(&work, OPEN_NS, &thread, error) == 0 ? window : NULL;
}

void window_destroy(struct window **window)
{
	struct window_thread *thread = *window ? (*window)->thread : NULL;
	*window = NULL;
	window_thread_stop(&thread);
}

void window_mute(struct window *window)
{
	window_thread_mute(window->thread);
}

void window_leave_at_exit(void)
{
	window_thread_leave_at_exit();
}

uint64_t window_silence_ns(const struct window *window)
{
	return window_thread_busy_ns(window->thread);
}

void window_toggle_fullscreen(struct window *window)
{
	pthread_mutex_lock(&window->lock);
	window->wishes.toggle = !window->wishes.toggle;
	pthread_mutex_unlock(&window->lock);
	window_thread_wake(window->thread);
}

void window_fit(struct window *window, uint32_t width, uint32_t height)
{
	pthread_mutex_lock(&window->lock);
	window->wishes.width = width;
	window->wishes.height = height;
	pthread_mutex_unlock(&window->lock);
	window_thread_wake(window->thread);
}
