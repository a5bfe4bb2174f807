/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/window.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <X11/Xlib.h>

#include "daemon/present/x_errors.h"

/* As glfw3native.h has them, which wants headers of more X11 libraries than are of use here. */
GLFWAPI Display *glfwGetX11Display(void);
GLFWAPI XID glfwGetGLXWindow(GLFWwindow *window);

/* Events may have been read from the connection by the drawing thread; then no descriptor tells of them. */
#define POLL_NS 10000000l
/* What the server must be asked for (is it mapped? where is it?) is asked for once in so many times, or after an event.
 */
#define POLLS_A_LOOK 10u
#define DEFAULT_WIDTH 1280
#define DEFAULT_HEIGHT 720

struct window {
	struct window_params params;
	GLFWwindow *glfw;
	GLFWwindow *shared; /* hidden: the context that others draw in; NULL: none */
	Display *display;   /* NULL: not X11 */
	bool glx;
	int event_fd, timer_fd;
	char monitor[64];        /* wished for */
	bool fullscreen;         /* wished for; it may not be while the monitor is unplugged */
	bool size_is_free;       /* nobody wished for one */
	bool repeated;           /* the key event before a character was a repetition */
	int x, y, width, height; /* of the window, for the way back from full screen */
	struct window_state state;
	GLFWmonitor *seen_monitor;
	bool seen_full, touched;
	uint32_t polls;
	atomic_bool lost;
	bool begun, open;  /* GLFW is initialised; there is a window */
	bool mode_changed; /* the monitor's, by full screen */
	struct error error;
	uint32_t wished_width, wished_height; /* window_fit(); 0: none */
	bool toggle_wished;
};

static const char *glfw_sentence(void)
{
	const char *text = NULL;
	return glfwGetError(&text) == GLFW_NO_ERROR || !text ? "no reason given" : text;
}

/* ---- monitors ---- */

static void describe_monitors(char *text, size_t size)
{
	int count = 0;
	GLFWmonitor **monitors = glfwGetMonitors(&count);
	size_t used = 0;
	text[0] = 0;
	for (int i = 0; i < count && used < size; i++)
		used +=
			(size_t)snprintf(text + used, size - used, "%s%d %s", i ? ", " : "", i, glfwGetMonitorName(monitors[i]));
}

/* By name or number; NULL: there is no such monitor now. */
static GLFWmonitor *find_monitor(const char *name)
{
	int count = 0;
	char *end;
	GLFWmonitor **monitors = glfwGetMonitors(&count);
	const long number = strtol(name, &end, 10);
	if (!*name)
		return count > 0 ? monitors[0] : NULL;
	if (!*end)
		return number >= 0 && number < count ? monitors[number] : NULL;
	for (int i = 0; i < count; i++)
		if (strcmp(glfwGetMonitorName(monitors[i]), name) == 0)
			return monitors[i];
	return NULL;
}

/* Of the modes with the size that the monitor has now, the one whose rate is nearest to the one wished for. */
static GLFWvidmode best_mode(GLFWmonitor *monitor, double refresh_hz)
{
	int count = 0;
	GLFWvidmode best = *glfwGetVideoMode(monitor);
	const GLFWvidmode *modes = glfwGetVideoModes(monitor, &count);
	for (int i = 0; i < count; i++)
		if (modes[i].width == best.width && modes[i].height == best.height &&
			fabs(modes[i].refreshRate - refresh_hz) < fabs(best.refreshRate - refresh_hz))
			best = modes[i];
	return best;
}

/* The one that most of the window is on. */
static GLFWmonitor *monitor_under(GLFWwindow *glfw)
{
	int count = 0, x, y, width, height, most = -1;
	GLFWmonitor **monitors = glfwGetMonitors(&count), *best = NULL;
	if (glfwGetWindowMonitor(glfw))
		return glfwGetWindowMonitor(glfw);
	glfwGetWindowPos(glfw, &x, &y);
	glfwGetWindowSize(glfw, &width, &height);
	for (int i = 0; i < count; i++) {
		int mx, my;
		const GLFWvidmode *mode = glfwGetVideoMode(monitors[i]);
		glfwGetMonitorPos(monitors[i], &mx, &my);
		const int right = x + width < mx + mode->width ? x + width : mx + mode->width;
		const int bottom = y + height < my + mode->height ? y + height : my + mode->height;
		const int across = right - (x > mx ? x : mx), down = bottom - (y > my ? y : my);
		const int area = across > 0 && down > 0 ? across * down : 0;
		if (area > most) {
			most = area;
			best = monitors[i];
		}
	}
	return best;
}

/* ---- what has changed ---- */

static void look(struct window *window, bool redraw)
{
	int width = 0, height = 0;
	GLFWmonitor *monitor = monitor_under(window->glfw);
	const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
	glfwGetFramebufferSize(window->glfw, &width, &height);
	const struct window_state state = {
		.width = (uint32_t)width,
		.height = (uint32_t)height,
		.hidden = width <= 0 || height <= 0 || glfwGetWindowAttrib(window->glfw, GLFW_ICONIFIED) ||
				  !glfwGetWindowAttrib(window->glfw, GLFW_VISIBLE),
		.refresh_hz = mode ? mode->refreshRate : 0.0,
		.changes = window->state.changes,
		.displays = window->state.displays,
	};
	if (!redraw && memcmp(&state, &window->state, sizeof(state)) == 0)
		return;
	const bool other = monitor != window->seen_monitor || !glfwGetWindowMonitor(window->glfw) != !window->seen_full ||
					   state.refresh_hz != window->state.refresh_hz || (window->state.hidden && !state.hidden);
	window->seen_monitor = monitor;
	window->seen_full = glfwGetWindowMonitor(window->glfw) != NULL;
	window->state = state;
	window->state.changes++;
	window->state.displays += other;
	window->params.changed(window->params.data, &window->state);
}

static void enter_fullscreen(struct window *window, GLFWmonitor *monitor)
{
	const GLFWvidmode mode = best_mode(monitor, window->params.refresh_hz);
	const GLFWvidmode *now = glfwGetVideoMode(monitor);
	window->mode_changed |= memcmp(&mode, now, sizeof(mode)) != 0;
	if (!glfwGetWindowMonitor(window->glfw)) {
		glfwGetWindowPos(window->glfw, &window->x, &window->y);
		glfwGetWindowSize(window->glfw, &window->width, &window->height);
	}
	glfwSetWindowMonitor(window->glfw, monitor, 0, 0, mode.width, mode.height, mode.refreshRate);
	glfwSetInputMode(window->glfw, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
	log_info(window->params.log, "glfw: full screen on %s, %dx%d at %d Hz", glfwGetMonitorName(monitor), mode.width,
			 mode.height, mode.refreshRate);
}

static void leave_fullscreen(struct window *window)
{
	glfwSetWindowMonitor(window->glfw, NULL, window->x, window->y, window->width, window->height, GLFW_DONT_CARE);
	glfwSetInputMode(window->glfw, GLFW_CURSOR, GLFW_CURSOR_NORMAL);
}

/* A monitor that was unplugged has taken full screen with it (GLFW makes a window of it); back when it is. */
static void follow_monitors(struct window *window)
{
	GLFWmonitor *wished = window->fullscreen ? find_monitor(window->monitor) : NULL;
	if (wished && !glfwGetWindowMonitor(window->glfw))
		enter_fullscreen(window, wished);
}

static void toggle_fullscreen(struct window *window)
{
	GLFWmonitor *monitor = *window->monitor ? find_monitor(window->monitor) : monitor_under(window->glfw);
	window->fullscreen = !window->fullscreen;
	if (!window->fullscreen)
		leave_fullscreen(window);
	else if (monitor)
		enter_fullscreen(window, monitor);
	look(window, true);
}

/* ---- callbacks ---- */

static struct window *window_of(GLFWwindow *glfw)
{
	return glfwGetWindowUserPointer(glfw);
}

static void on_key(GLFWwindow *glfw, int key, int scancode, int action, int modifiers)
{
	struct window *window = window_of(glfw);
	(void)scancode;
	(void)modifiers;
	window->repeated = action == GLFW_REPEAT;
	if (action == GLFW_PRESS && (key == GLFW_KEY_ESCAPE || key == GLFW_KEY_F1))
		window->params.key(window->params.data, key == GLFW_KEY_F1 ? PRESENTER_KEY_F1 : PRESENTER_KEY_ESCAPE);
}

/* Letters by what is printed on the key, not by where it lies. */
static void on_character(GLFWwindow *glfw, unsigned code)
{
	struct window *window = window_of(glfw);
	if (!window->repeated)
		window->params.key(window->params.data, code >= 'A' && code <= 'Z' ? code - 'A' + 'a' : code);
}

static void on_close(GLFWwindow *glfw)
{
	struct window *window = window_of(glfw);
	glfwSetWindowShouldClose(glfw, GLFW_FALSE);
	window->params.key(window->params.data, PRESENTER_KEY_CLOSE);
}

static void on_refresh(GLFWwindow *glfw)
{
	look(window_of(glfw), true);
}

static void on_moved(GLFWwindow *glfw, int x, int y)
{
	(void)x;
	(void)y;
	window_of(glfw)->touched = true;
}

static void on_iconified(GLFWwindow *glfw, int iconified)
{
	(void)iconified;
	window_of(glfw)->touched = true;
}

/* ---- a server that goes away ---- */

/* On any thread. */
static void say_lost(struct window *window)
{
	if (!atomic_exchange(&window->lost, true))
		window->params.lost(window->params.data, "glfw: the connection to the X server broke");
}

static void on_broken(Display *display, void *data)
{
	(void)display;
	say_lost(data);
}

/* On main. False if the connection broke within. */
static bool call_safely(void (*function)(void *window), struct window *window)
{
	const bool fine = x_errors_call(function, window);
	if (!fine)
		say_lost(window);
	return fine;
}

/* ---- life ---- */

static void set_hints(int kind, int major, int minor)
{
	glfwDefaultWindowHints();
	glfwWindowHint(GLFW_CONTEXT_CREATION_API, kind);
	glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, major);
	glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, minor);
	glfwWindowHint(GLFW_DEPTH_BITS, 0);
	glfwWindowHint(GLFW_STENCIL_BITS, 0);
	glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
}

/* A context of GLX costs less than one of EGL where a CPU draws; whichever there is. */
static GLFWwindow *open_glfw(int width, int height, const char *title)
{
	static const int kinds[] = {GLFW_NATIVE_CONTEXT_API, GLFW_EGL_CONTEXT_API};
	GLFWwindow *glfw = NULL;
	for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]) && !glfw; i++) {
		set_hints(kinds[i], 3, 0);
		glfw = glfwCreateWindow(width, height, title, NULL, NULL);
	}
	return glfw;
}

/* A context that shares with the window's comes with a window of its own, which nobody sees. */
static void open_shared(struct window *window)
{
	set_hints(glfwGetWindowAttrib(window->glfw, GLFW_CONTEXT_CREATION_API), 4, 3);
	glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
	glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
	window->shared = glfwCreateWindow(16, 16, "", NULL, window->glfw);
	if (!window->shared)
		log_info(window->params.log, "glfw: no second context with OpenGL 4.3 (%s): pictures come through CPU memory",
				 glfw_sentence());
}

static int watch(int epoll_fd, int fd)
{
	struct epoll_event event = {.events = EPOLLIN};
	return fd >= 0 && epoll_ctl(epoll_fd, EPOLL_CTL_ADD, fd, &event) == 0 ? 0 : -errno;
}

static int open_event_fds(struct window *window, struct error *error)
{
	const struct itimerspec often = {{0, POLL_NS}, {0, POLL_NS}};
	window->event_fd = epoll_create1(EPOLL_CLOEXEC);
	window->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	if (watch(window->event_fd, window->timer_fd) < 0 || timerfd_settime(window->timer_fd, 0, &often, NULL) < 0 ||
		(window->display && watch(window->event_fd, ConnectionNumber(window->display)) < 0))
		return error_set(error, -errno, "glfw: no descriptors for events: %s", strerror(errno));
	return 0;
}

static int open_window(struct window *window, struct error *error)
{
	const struct presenter_options *options = window->params.options;
	GLFWmonitor *monitor = find_monitor(window->monitor);
	char monitors[256];
	if (*window->monitor && !monitor) {
		describe_monitors(monitors, sizeof(monitors));
		return error_set(error, -ENODEV, "glfw: monitor: there is no \"%s\"; there are %s", window->monitor,
						 *monitors ? monitors : "none");
	}
	window->width = options->width ? (int)options->width : DEFAULT_WIDTH;
	window->height = options->height ? (int)options->height : DEFAULT_HEIGHT;
	window->glfw = open_glfw(window->width, window->height, options->title ? options->title : "Pursuit");
	if (!window->glfw)
		return error_set(error, -ENODEV, "glfw: no window with OpenGL 3.0: %s", glfw_sentence());
	glfwSetWindowUserPointer(window->glfw, window);
	glfwSetKeyCallback(window->glfw, on_key);
	glfwSetCharCallback(window->glfw, on_character);
	glfwSetWindowCloseCallback(window->glfw, on_close);
	glfwSetWindowRefreshCallback(window->glfw, on_refresh);
	glfwSetFramebufferSizeCallback(window->glfw, on_moved);
	glfwSetWindowPosCallback(window->glfw, on_moved);
	glfwSetWindowIconifyCallback(window->glfw, on_iconified);
	window->glx = glfwGetWindowAttrib(window->glfw, GLFW_CONTEXT_CREATION_API) == GLFW_NATIVE_CONTEXT_API;
	if (options->share_gl)
		open_shared(window);
	if (window->fullscreen && monitor)
		enter_fullscreen(window, monitor);
	return open_event_fds(window, error);
}

/* GLFW was left behind by a window whose server went away; only a new process can open another one. */
static bool connection_is_broken(void)
{
	Display *display = glfwGetX11Display();
	struct pollfd connection = {.fd = display ? ConnectionNumber(display) : -1, .events = POLLIN};
	return display && poll(&connection, 1, 0) == 1 && (connection.revents & (POLLHUP | POLLERR | POLLNVAL));
}

bool window_is_possible(void)
{
	return x_errors_can_connect();
}

static void begin(void *data)
{
	struct window *window = data;
	window->begun = glfwInit() && !connection_is_broken();
	if (!window->begun) {
		error_set(&window->error, -ENODEV, "glfw: no window system: %s; is DISPLAY set?", glfw_sentence());
		return;
	}
	window->display = glfwGetX11Display();
	if (window->display)
		x_errors_watch(window->display, on_broken, window);
	window->open = open_window(window, &window->error) == 0;
	if (window->open)
		look(window, true);
}

struct window *window_create(const struct window_params *params, struct error *error)
{
	struct window *window = calloc(1, sizeof(*window));
	if (!window) {
		error_set(error, -ENOMEM, "glfw: out of memory");
		return NULL;
	}
	window->params = *params;
	window->event_fd = window->timer_fd = -1;
	window->fullscreen = params->options->fullscreen;
	window->size_is_free = params->options->width == 0;
	snprintf(window->monitor, sizeof(window->monitor), "%s", params->options->monitor ? params->options->monitor : "");
	error_set(&window->error, -ENODEV, "glfw: the connection to the X server broke");
	x_errors_survive();
	call_safely(begin, window);
	if (window->open && !atomic_load(&window->lost))
		return window;
	*error = window->error;
	window_destroy(&window);
	return NULL;
}

/* libGLX would tidy up a connection that nobody may touch any more. */
static void leave_at_once(int status, void *data)
{
	(void)data;
	fflush(NULL);
	_exit(status);
}

static void end(void *data)
{
	struct window *window = data;
	x_errors_survive();
	if (window->shared)
		glfwDestroyWindow(window->shared);
	if (window->glfw)
		glfwDestroyWindow(window->glfw);
	glfwTerminate();
}

void window_destroy(struct window **window)
{
	struct window *self = *window;
	*window = NULL;
	if (!self)
		return;
	/* GLFW would ask a server that is gone how to put the mode back. */
	if (self->begun && atomic_load(&self->lost) && self->mode_changed)
		on_exit(leave_at_once, NULL);
	else if (self->begun && !call_safely(end, self))
		on_exit(leave_at_once, NULL);
	if (self->event_fd >= 0)
		close(self->event_fd);
	if (self->timer_fd >= 0)
		close(self->timer_fd);
	free(self);
}

int window_get_event_fd(const struct window *window)
{
	return window->event_fd;
}

static void fit(struct window *window, uint32_t width, uint32_t height)
{
	GLFWmonitor *monitor = monitor_under(window->glfw);
	const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
	if (mode && (width > (uint32_t)mode->width || height > (uint32_t)mode->height))
		return;
	window->width = (int)width;
	window->height = (int)height;
	if (!glfwGetWindowMonitor(window->glfw))
		glfwSetWindowSize(window->glfw, (int)width, (int)height);
}

static void process_events(void *data)
{
	struct window *window = data;
	x_errors_survive();
	glfwPollEvents();
	if (window->wished_width)
		fit(window, window->wished_width, window->wished_height);
	if (window->toggle_wished)
		toggle_fullscreen(window);
	window->wished_width = 0;
	window->toggle_wished = false;
	if (!window->touched && ++window->polls < POLLS_A_LOOK)
		return;
	window->touched = false;
	window->polls = 0;
	follow_monitors(window);
	look(window, false);
}

void window_process_events(struct window *window)
{
	uint64_t count;
	if (read(window->timer_fd, &count, sizeof(count)) < 0) {
		/* It was the display server. */
	}
	if (atomic_load(&window->lost))
		return;
	call_safely(process_events, window);
}

void window_toggle_fullscreen(struct window *window)
{
	window->toggle_wished = !window->toggle_wished;
}

void window_fit(struct window *window, uint32_t width, uint32_t height)
{
	if (!window->size_is_free)
		return;
	window->size_is_free = false;
	window->wished_width = width;
	window->wished_height = height;
}

/* ---- whoever draws the pictures ---- */

static bool enter_shared(void *data)
{
	struct window *window = data;
	if (atomic_load(&window->lost))
		return false;
	if (glfwGetCurrentContext() != window->shared)
		glfwMakeContextCurrent(window->shared);
	return glfwGetCurrentContext() == window->shared && !atomic_load(&window->lost);
}

static void release_shared(void *data)
{
	(void)data;
	glfwMakeContextCurrent(NULL);
}

bool window_get_context(struct window *window, struct presenter_context *context)
{
	*context = (struct presenter_context){.name = window->glx ? "window (GLX)" : "window (EGL)",
										  .enter = enter_shared,
										  .release = release_shared,
										  .find = window_find_function,
										  .data = window};
	return window->shared != NULL;
}

/* ---- the drawing thread ---- */

int window_make_current(struct window *window, struct error *error)
{
	glfwMakeContextCurrent(window->glfw);
	if (glfwGetCurrentContext() != window->glfw)
		return error_set(error, -EIO, "glfw: the context cannot be used: %s", glfw_sentence());
	glfwSwapInterval(1);
	return 0;
}

void window_let_go(struct window *window)
{
	(void)window;
	glfwMakeContextCurrent(NULL);
}

void window_swap(struct window *window)
{
	if (!atomic_load(&window->lost))
		glfwSwapBuffers(window->glfw);
}

window_function window_find_function(const char *name)
{
	return (window_function)glfwGetProcAddress(name);
}

bool window_has_extension(const char *name)
{
	return glfwExtensionSupported(name) == GLFW_TRUE;
}

bool window_get_glx(struct window *window, void **display, unsigned long *drawable)
{
	if (!window->display || !window->glx)
		return false;
	*display = window->display;
	*drawable = glfwGetGLXWindow(window->glfw);
	return *drawable != 0;
}
