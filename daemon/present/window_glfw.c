/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/window_glfw.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <X11/Xlib.h>

#include "daemon/present/x_errors.h"

/* As glfw3native.h has them, which wants headers of more X11 libraries than are of use here. */
GLFWAPI Display *glfwGetX11Display(void);
GLFWAPI XID glfwGetGLXWindow(GLFWwindow *window);
GLFWAPI XID glfwGetX11Monitor(GLFWmonitor *monitor);

/* What the server must be asked for (is it mapped? where is it?) is asked for once in so many times, or after an event.
 */
#define POLLS_A_LOOK 10u
#define DEFAULT_WIDTH 1280
#define DEFAULT_HEIGHT 720

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

/* Of the window, in pixels. */
static int area_on(GLFWwindow *glfw, GLFWmonitor *monitor)
{
	int x, y, width, height, mx, my;
	const GLFWvidmode *mode = glfwGetVideoMode(monitor);
	glfwGetWindowPos(glfw, &x, &y);
	glfwGetWindowSize(glfw, &width, &height);
	glfwGetMonitorPos(monitor, &mx, &my);
	const int right = x + width < mx + mode->width ? x + width : mx + mode->width;
	const int bottom = y + height < my + mode->height ? y + height : my + mode->height;
	const int across = right - (x > mx ? x : mx), down = bottom - (y > my ? y : my);
	return across > 0 && down > 0 ? across * down : 0;
}

/* The one that most of the window is on. */
static GLFWmonitor *monitor_under(GLFWwindow *glfw)
{
	int count = 0, most = -1;
	GLFWmonitor **monitors = glfwGetMonitors(&count), *best = NULL;
	if (glfwGetWindowMonitor(glfw))
		return glfwGetWindowMonitor(glfw);
	for (int i = 0; i < count; i++) {
		const int area = area_on(glfw, monitors[i]);
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
	window_tell_changed(window);
}

/* The mode is changed before GLFW sees it, which so has none to put back. */
static void enter_fullscreen(struct window *window, GLFWmonitor *monitor)
{
	double rate = 0.0;
	if (window->display)
		rate = x_mode_change(&window->mode, window->display, glfwGetX11Monitor(monitor), window->params.refresh_hz);
	const GLFWvidmode mode = *glfwGetVideoMode(monitor);
	if (!glfwGetWindowMonitor(window->glfw)) {
		glfwGetWindowPos(window->glfw, &window->x, &window->y);
		glfwGetWindowSize(window->glfw, &window->width, &window->height);
	}
	glfwSetWindowMonitor(window->glfw, monitor, 0, 0, mode.width, mode.height, mode.refreshRate);
	glfwSetInputMode(window->glfw, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
	window->is_full = true;
	window_say(window, "glfw: full screen on %s, %dx%d at %.2f Hz", glfwGetMonitorName(monitor), mode.width,
			   mode.height, rate > 0.0 ? rate : mode.refreshRate);
}

static void leave_fullscreen(struct window *window)
{
	glfwSetWindowMonitor(window->glfw, NULL, window->x, window->y, window->width, window->height, GLFW_DONT_CARE);
	glfwSetInputMode(window->glfw, GLFW_CURSOR, GLFW_CURSOR_NORMAL);
	window->is_full = false;
	if (window->display)
		x_mode_restore(&window->mode, window->display);
}

/* GLFW has made a window of it, which without a window manager may lie anywhere. */
static void lose_fullscreen(struct window *window)
{
	int x, y;
	leave_fullscreen(window);
	GLFWmonitor *monitor = monitor_under(window->glfw);
	if (!monitor || area_on(window->glfw, monitor) > 0)
		return;
	glfwGetMonitorPos(monitor, &x, &y);
	glfwSetWindowPos(window->glfw, x, y);
}

/* A monitor that was unplugged has taken full screen with it; back when it is. */
static void follow_monitors(struct window *window)
{
	GLFWmonitor *wished = window->fullscreen ? find_monitor(window->monitor) : NULL;
	if (window->is_full && !glfwGetWindowMonitor(window->glfw))
		lose_fullscreen(window);
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
		window_tell_key(window, key == GLFW_KEY_F1 ? PRESENTER_KEY_F1 : PRESENTER_KEY_ESCAPE);
}

/* Letters by what is printed on the key, not by where it lies. */
static void on_character(GLFWwindow *glfw, unsigned code)
{
	struct window *window = window_of(glfw);
	if (!window->repeated)
		window_tell_key(window, code >= 'A' && code <= 'Z' ? code - 'A' + 'a' : code);
}

static void on_close(GLFWwindow *glfw)
{
	glfwSetWindowShouldClose(glfw, GLFW_FALSE);
	window_tell_key(window_of(glfw), PRESENTER_KEY_CLOSE);
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

static void on_broken(Display *display, void *data)
{
	(void)display;
	window_tell_lost(data);
}

/* False if the connection broke within. */
static bool call_safely(void (*function)(void *window), struct window *window)
{
	const bool fine = x_errors_call(function, window);
	if (!fine)
		window_tell_lost(window);
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
		window_say(window, "glfw: no second context with OpenGL 4.3 (%s): pictures come through CPU memory",
				   glfw_sentence());
}

static int open_window(struct window *window, struct error *error)
{
	const struct presenter_options *options = &window->options;
	GLFWmonitor *monitor = find_monitor(window->monitor);
	char monitors[256];
	if (*window->monitor && !monitor) {
		describe_monitors(monitors, sizeof(monitors));
		return error_set(error, -ENODEV, "glfw: monitor: there is no \"%s\"; there are %s", window->monitor,
						 *monitors ? monitors : "none");
	}
	window->width = options->width ? (int)options->width : DEFAULT_WIDTH;
	window->height = options->height ? (int)options->height : DEFAULT_HEIGHT;
	window->glfw = open_glfw(window->width, window->height, window->title);
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
	return 0;
}

/* GLFW was left behind by a window whose server went away; only a new process can open another one. */
static bool connection_is_broken(void)
{
	Display *display = glfwGetX11Display();
	struct pollfd connection = {.fd = display ? ConnectionNumber(display) : -1, .events = POLLIN};
	return display && poll(&connection, 1, 0) == 1 && (connection.revents & (POLLHUP | POLLERR | POLLNVAL));
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

int window_glfw_open(struct window *window, struct error *error)
{
	error_set(&window->error, -ENODEV, "glfw: the connection to the X server broke");
	x_errors_survive();
	call_safely(begin, window);
	if (window->open && !atomic_load(&window->lost))
		return 0;
	*error = window->error;
	return -ENODEV;
}

static void end(void *data)
{
	struct window *window = data;
	x_errors_survive();
	if (window->display)
		x_mode_restore(&window->mode, window->display);
	if (window->shared)
		glfwDestroyWindow(window->shared);
	if (window->glfw)
		glfwDestroyWindow(window->glfw);
	glfwTerminate();
}

bool window_glfw_close(struct window *window)
{
	if (!window->begun || call_safely(end, window))
		return true;
	x_mode_abandon(&window->mode);
	return false;
}

/* ---- events ---- */

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
	const struct window_wishes wishes = window_take_wishes(window);
	x_errors_survive();
	glfwPollEvents();
	if (wishes.width && window->size_is_free) {
		window->size_is_free = false;
		fit(window, wishes.width, wishes.height);
	}
	if (wishes.toggle)
		toggle_fullscreen(window);
	if (!window->touched && ++window->polls < POLLS_A_LOOK)
		return;
	window->touched = false;
	window->polls = 0;
	follow_monitors(window);
	look(window, false);
}

void window_glfw_process(struct window *window)
{
	call_safely(process_events, window);
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
