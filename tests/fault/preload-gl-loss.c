/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Loaded before all else (LD_PRELOAD): the GPU is reset, as far as GL tells,
 * once for each time that the file $PURSUIT_TEST_LOSE is made; and there is no
 * memory for a texture as long as the file $PURSUIT_TEST_NO_MEMORY exists.
 */
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef void (*function)(void);

#define GUILTY_CONTEXT_RESET 0x8253u
#define OUT_OF_MEMORY 0x0505u

static _Thread_local unsigned pending; /* an error of GL */

function eglGetProcAddress(const char *name);

static unsigned reset_status(void)
{
	const char *path = getenv("PURSUIT_TEST_LOSE");
	return path && unlink(path) == 0 ? GUILTY_CONTEXT_RESET : 0;
}

static function find(const char *name)
{
	union {
		void *object;
		function (*call)(const char *name);
	} real = {.object = dlsym(RTLD_NEXT, "eglGetProcAddress")};
	return real.call(name);
}

static unsigned get_error(void)
{
	const unsigned error = pending;
	pending = 0;
	return error ? error : ((unsigned (*)(void))find("glGetError"))();
}

static void make_texture(unsigned target, int level, int kind, int width, int height, int border, unsigned format,
						 unsigned type, const void *pixels)
{
	const char *path = getenv("PURSUIT_TEST_NO_MEMORY");
	if (path && access(path, F_OK) == 0)
		pending = OUT_OF_MEMORY;
	else
		((void (*)(unsigned, int, int, int, int, int, unsigned, unsigned, const void *))find("glTexImage2D"))(
			target, level, kind, width, height, border, format, type, pixels);
}

function eglGetProcAddress(const char *name)
{
	if (strncmp(name, "glGetGraphicsResetStatus", 24) == 0)
		return (function)reset_status;
	if (strcmp(name, "glGetError") == 0)
		return (function)get_error;
	if (strcmp(name, "glTexImage2D") == 0)
		return (function)make_texture;
	return find(name);
}
