/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Loaded before all else (LD_PRELOAD): the GPU is reset, as far as GL tells,
 * once for each time that the file $PURSUIT_TEST_LOSE is made.
 */
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef void (*function)(void);

#define GUILTY_CONTEXT_RESET 0x8253u

function eglGetProcAddress(const char *name);

static unsigned reset_status(void)
{
	const char *path = getenv("PURSUIT_TEST_LOSE");
	return path && unlink(path) == 0 ? GUILTY_CONTEXT_RESET : 0;
}

function eglGetProcAddress(const char *name)
{
	union {
		void *object;
		function (*call)(const char *name);
	} real = {.object = dlsym(RTLD_NEXT, "eglGetProcAddress")};
	if (strncmp(name, "glGetGraphicsResetStatus", 24) == 0)
		return (function)reset_status;
	return real.call(name);
}
