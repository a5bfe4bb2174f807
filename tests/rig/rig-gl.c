/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Scan-out buffers that GL draws into, on the kernel's virtual display, with a GL that can be made to fail. */
#include <EGL/egl.h>
#include <GL/glcorearb.h>

#include "daemon/present/kms_device.h"
#include "daemon/present/kms_gl.h"
#include "tests/test.h"

#define WIDTH 160u
#define HEIGHT 120u

/* ---- GL with a say of this test's ---- */

typedef void (*function)(void);

static struct {
	PFNGLGENTEXTURESPROC gen_textures;
	PFNGLDELETETEXTURESPROC delete_textures;
	PFNGLCHECKFRAMEBUFFERSTATUSPROC check_framebuffer_status;
	int textures; /* that are there */
	bool refuses; /* nothing can be drawn into */
} fake;

static void APIENTRY gen_textures(GLsizei count, GLuint *names)
{
	fake.textures += count;
	fake.gen_textures(count, names);
}

static void APIENTRY delete_textures(GLsizei count, const GLuint *names)
{
	fake.textures -= count;
	fake.delete_textures(count, names);
}

static GLenum APIENTRY check_framebuffer_status(GLenum target)
{
	return fake.refuses ? GL_FRAMEBUFFER_UNSUPPORTED : fake.check_framebuffer_status(target);
}

function __real_eglGetProcAddress(const char *name);
function __wrap_eglGetProcAddress(const char *name);

function __wrap_eglGetProcAddress(const char *name)
{
	const function real = __real_eglGetProcAddress(name);
	if (strcmp(name, "glGenTextures") == 0) {
		fake.gen_textures = (PFNGLGENTEXTURESPROC)real;
		return (function)gen_textures;
	}
	if (strcmp(name, "glDeleteTextures") == 0) {
		fake.delete_textures = (PFNGLDELETETEXTURESPROC)real;
		return (function)delete_textures;
	}
	if (strcmp(name, "glCheckFramebufferStatus") == 0) {
		fake.check_framebuffer_status = (PFNGLCHECKFRAMEBUFFERSTATUSPROC)real;
		return (function)check_framebuffer_status;
	}
	return real;
}

/* ---- */

static struct kms_device *device;
static struct kms_gl *gl;

static void open_display(void)
{
	struct kms_device_params params = {.connector = NULL};
	struct error error = {""};
	CHECK_INT(kms_mode_parse("160x120@120", &params.mode, &error), 0);
	device = kms_device_create(&params, &error);
	gl = device ? kms_gl_create(kms_device_get_fd(device), &error) : NULL;
	if (!gl || !kms_gl_get_context(gl)->enter(kms_gl_get_context(gl)->data))
		SKIP(error.text);
}

static void close_display(void)
{
	kms_gl_get_context(gl)->release(kms_gl_get_context(gl)->data);
	kms_gl_destroy(&gl);
	kms_device_destroy(&device);
}

/* A buffer that GL does not draw into, and one that is not taken over, leave nothing behind. */
static void test_nothing_stays_behind(void)
{
	struct kms_gl_buffer buffer;
	struct error error = {""};
	open_display();
	fake.refuses = true;
	CHECK(kms_gl_create_buffer(gl, WIDTH, HEIGHT, &buffer, &error) < 0);
	CHECK(strstr(error.text, "160x120") != NULL);
	CHECK(buffer.texture == 0 && !buffer.bo && !buffer.image);
	CHECK_INT(fake.textures, 0);
	fake.refuses = false;
	CHECK_INT(kms_gl_create_buffer(gl, WIDTH, HEIGHT, &buffer, &error), 0);
	CHECK_INT(fake.textures, 1);
	kms_gl_destroy_buffer(gl, &buffer);
	CHECK_INT(fake.textures, 0);
	close_display();
}

int main(void)
{
	RUN(test_nothing_stays_behind);
	return test_result();
}
