/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/rig/fake-gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>

/* Of the kernel's drivers/dma-buf/sw_sync.c. */
#define TIMELINES "/sys/kernel/debug/sync/sw_sync"
struct sw_sync_create_fence_data {
	uint32_t value;
	char name[32];
	int32_t fence;
};
#define SW_SYNC_IOC_CREATE_FENCE _IOWR('W', 0, struct sw_sync_create_fence_data)
#define SW_SYNC_IOC_INC _IOW('W', 1, uint32_t)

typedef void (*function)(void);

struct fake_gl fake_gl;

static struct {
	PFNGLGENTEXTURESPROC gen_textures;
	PFNGLDELETETEXTURESPROC delete_textures;
	PFNGLCHECKFRAMEBUFFERSTATUSPROC check_framebuffer_status;
	PFNGLFINISHPROC finish;
} real;

/* ---- fences ---- */

static int timeline = -1;
static uint32_t signalled;
static long delay_ms; /* 0: signalled by the test */

bool fake_gl_open_fences(void)
{
	if (timeline < 0)
		timeline = open(TIMELINES, O_RDWR | O_CLOEXEC);
	return timeline >= 0;
}

/* Without a test that signals: after a while. */
static void *signal_later(void *data)
{
	const struct timespec delay = {0, delay_ms * 1000000};
	const uint32_t one = 1;
	(void)data;
	nanosleep(&delay, NULL);
	if (ioctl(timeline, SW_SYNC_IOC_INC, &one) != 0)
		perror("sw_sync");
	return NULL;
}

static void start_signal(void)
{
	pthread_t thread;
	if (delay_ms > 0 && pthread_create(&thread, NULL, signal_later, NULL) == 0)
		pthread_detach(thread);
}

void fake_gl_signal(void)
{
	const uint32_t count = fake_gl.fences - signalled;
	signalled = fake_gl.fences;
	if (count > 0 && ioctl(timeline, SW_SYNC_IOC_INC, &count) != 0)
		perror("sw_sync");
}

static EGLSyncKHR EGLAPIENTRY create_sync(EGLDisplay display, EGLenum type, const EGLint *attributes)
{
	return type == EGL_SYNC_NATIVE_FENCE_ANDROID && !fake_gl.breaks ? (EGLSyncKHR)&fake_gl : EGL_NO_SYNC_KHR;
}

static EGLBoolean EGLAPIENTRY destroy_sync(EGLDisplay display, EGLSyncKHR sync)
{
	return sync == (EGLSyncKHR)&fake_gl;
}

static EGLint EGLAPIENTRY dup_fence(EGLDisplay display, EGLSyncKHR sync)
{
	struct sw_sync_create_fence_data data = {.value = fake_gl.fences + 1, .name = "picture"};
	if (sync != (EGLSyncKHR)&fake_gl || ioctl(timeline, SW_SYNC_IOC_CREATE_FENCE, &data) != 0)
		return EGL_NO_NATIVE_FENCE_FD_ANDROID;
	fake_gl.fences++;
	start_signal();
	return data.fence;
}

/* ---- textures ---- */

static void APIENTRY gen_textures(GLsizei count, GLuint *names)
{
	fake_gl.textures += count;
	real.gen_textures(count, names);
}

static void APIENTRY delete_textures(GLsizei count, const GLuint *names)
{
	fake_gl.textures -= count;
	real.delete_textures(count, names);
}

static GLenum APIENTRY check_framebuffer_status(GLenum target)
{
	return fake_gl.refuses ? GL_FRAMEBUFFER_UNSUPPORTED : real.check_framebuffer_status(target);
}

static void APIENTRY finish(void)
{
	fake_gl.waits++;
	real.finish();
}

/* ---- what stands before EGL ---- */

typedef function (*find_function)(const char *name);
typedef const char *(*query_function)(EGLDisplay display, EGLint name);

static function find_next(const char *name)
{
	function next = NULL;
	void *symbol = dlsym(RTLD_NEXT, name);
	memcpy(&next, &symbol, sizeof(next));
	return next;
}

static const struct {
	const char *name;
	function *real;
	function fake;
} functions[] = {
	{"glGenTextures", (function *)&real.gen_textures, (function)gen_textures},
	{"glDeleteTextures", (function *)&real.delete_textures, (function)delete_textures},
	{"glCheckFramebufferStatus", (function *)&real.check_framebuffer_status, (function)check_framebuffer_status},
	{"glFinish", (function *)&real.finish, (function)finish},
	{"eglCreateSyncKHR", NULL, (function)create_sync},
	{"eglDestroySyncKHR", NULL, (function)destroy_sync},
	{"eglDupNativeFenceFDANDROID", NULL, (function)dup_fence},
};

function eglGetProcAddress(const char *name)
{
	const find_function next = (find_function)find_next("eglGetProcAddress");
	for (size_t i = 0; i < sizeof(functions) / sizeof(functions[0]); i++) {
		if (strcmp(name, functions[i].name) != 0)
			continue;
		if (functions[i].real)
			*functions[i].real = next(name);
		return functions[i].fake;
	}
	return next(name);
}

const char *eglQueryString(EGLDisplay display, EGLint name)
{
	static char extensions[8192];
	const char *text = ((query_function)find_next("eglQueryString"))(display, name);
	if (name != EGL_EXTENSIONS || !fake_gl.has_fences || !text)
		return text;
	snprintf(extensions, sizeof(extensions), "%s EGL_ANDROID_native_fence_sync", text);
	return extensions;
}

/* ---- before a program that knows nothing of it ---- */

__attribute__((constructor)) static void start(void)
{
	const char *delay = getenv("FAKE_FENCES_MS");
	if (!delay || !fake_gl_open_fences())
		return;
	delay_ms = atol(delay);
	fake_gl.has_fences = true;
}
