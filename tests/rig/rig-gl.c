/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Scan-out buffers that GL draws into, on the kernel's virtual display, with a GL that can be made to fail. */
#include <EGL/egl.h>
#include <GL/glcorearb.h>
#include <errno.h>
#include <poll.h>
#include <unistd.h>

#include "daemon/present/kms_device.h"
#include "daemon/present/kms_gl.h"
#include "tests/rig/fake-gl.h"
#include "tests/test.h"

#define WIDTH 160u
#define HEIGHT 120u
/* Of a picture that is made smaller. */
#define TOLERANCE 4.0

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
	fake_gl.refuses = true;
	CHECK(kms_gl_create_buffer(gl, WIDTH, HEIGHT, &buffer, &error) < 0);
	CHECK(strstr(error.text, "160x120") != NULL);
	CHECK(buffer.texture == 0 && !buffer.bo && !buffer.image);
	CHECK_INT(fake_gl.textures, 0);
	fake_gl.refuses = false;
	CHECK_INT(kms_gl_create_buffer(gl, WIDTH, HEIGHT, &buffer, &error), 0);
	CHECK_INT(fake_gl.textures, 1);
	kms_gl_destroy_buffer(gl, &buffer);
	CHECK_INT(fake_gl.textures, 0);
	close_display();
}

/* ---- pictures made smaller ---- */

#define FUNCTION(type, name) const type name = (type)eglGetProcAddress("gl" #name)

/* Left half: columns of black and white in turn; right half: one colour. */
static void fill(const struct kms_gl_large *large)
{
	FUNCTION(PFNGLBINDTEXTUREPROC, BindTexture);
	FUNCTION(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D);
	uint32_t *pixels = malloc((size_t)large->width * large->height * 4);
	for (uint32_t y = 0; y < large->height; y++)
		for (uint32_t x = 0; x < large->width; x++)
			pixels[y * large->width + x] = x >= large->width / 2 ? 0xff804020u : x % 2 ? 0xffffffffu : 0xff000000u;
	BindTexture(GL_TEXTURE_2D, large->texture);
	TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, (GLsizei)large->width, (GLsizei)large->height, GL_BGRA,
				  GL_UNSIGNED_INT_8_8_8_8_REV, pixels);
	free(pixels);
}

static void read_back(const struct kms_gl_buffer *buffer, uint32_t pixels[HEIGHT][WIDTH])
{
	FUNCTION(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers);
	FUNCTION(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers);
	FUNCTION(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer);
	FUNCTION(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D);
	FUNCTION(PFNGLREADPIXELSPROC, ReadPixels);
	GLuint framebuffer;
	GenFramebuffers(1, &framebuffer);
	BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
	FramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, buffer->texture, 0);
	ReadPixels(0, 0, WIDTH, HEIGHT, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, pixels);
	DeleteFramebuffers(1, &framebuffer);
}

static void check_colour(uint32_t pixel, uint32_t want)
{
	for (int shift = 0; shift < 24; shift += 8)
		CHECK_NEAR(pixel >> shift & 255, want >> shift & 255, TOLERANCE);
}

/* To 120 x 90 with black around it. grey: of the fine columns; 0: whatever. */
static void shrink(uint32_t width, uint32_t height, uint32_t grey)
{
	const struct rectangle part = {20, 15, 120, 90};
	static uint32_t pixels[HEIGHT][WIDTH];
	struct kms_gl_large large = {0, 0, 0};
	struct kms_gl_buffer buffer;
	struct error error = {""};
	CHECK_INT(kms_gl_create_buffer(gl, WIDTH, HEIGHT, &buffer, &error), 0);
	CHECK_INT(kms_gl_resize(gl, &large, width, height, &error), 0);
	fill(&large);
	kms_gl_shrink(gl, &large, &buffer, &part);
	read_back(&buffer, pixels);
	check_colour(pixels[14][80], 0);
	check_colour(pixels[105][80], 0);
	check_colour(pixels[60][19], 0);
	check_colour(pixels[60][140], 0);
	check_colour(pixels[16][138], 0x804020);
	check_colour(pixels[103][82], 0x804020);
	for (uint32_t x = 22; x < 78 && grey > 0; x += 7)
		check_colour(pixels[40 + x / 2][x], grey * 0x10101u);
	CHECK_INT(kms_gl_resize(gl, &large, 0, 0, &error), 0);
	kms_gl_destroy_buffer(gl, &buffer);
	CHECK_INT(fake_gl.textures, 0);
}

/* What is halved keeps its light: half of it is code 188 of sRGB, not 128. */
static void test_smaller_pictures(void)
{
	open_display();
	shrink(240, 180, 188);
	shrink(960, 720, 188);
	shrink(360, 270, 188);
	shrink(180, 135, 0);
	shrink(121, 91, 0);
	close_display();
}

/* ---- fences ---- */

static void on_vblank(void *data, uint64_t sequence, uint64_t time_ns)
{
	(void)data;
	(void)sequence;
	(void)time_ns;
}

static void on_flipped(void *data, uint64_t sequence, uint64_t time_ns)
{
	(void)time_ns;
	*(uint64_t *)data = sequence;
}

/* The vblank that the flip happened at; 0: it has not by then. */
static uint64_t wait_for_flip(int milliseconds)
{
	uint64_t flipped = 0;
	const struct kms_events events = {on_vblank, on_flipped, &flipped};
	struct pollfd fd = {kms_device_get_fd(device), POLLIN, 0};
	if (poll(&fd, 1, milliseconds) == 1)
		CHECK_INT(kms_device_read_events(device, &events), 0);
	return flipped;
}

static uint64_t sequence_now(void)
{
	uint64_t sequence = 0, time_ns;
	CHECK_INT(kms_device_get_sequence(device, &sequence, &time_ns), 0);
	return sequence;
}

/* The kernel waits for the fence, and no longer. */
static void test_fence(void)
{
	struct kms_buffer buffers[2];
	struct error error = {""};
	if (!fake_gl_open_fences())
		SKIP("the kernel has no fences for tests");
	fake_gl.has_fences = true;
	open_display();
	CHECK(kms_gl_can_fence(gl));
	CHECK(kms_device_takes_fences(device));
	for (int i = 0; i < 2; i++)
		CHECK_INT(kms_device_create_buffer(device, &buffers[i], &error), 0);
	CHECK_INT(kms_device_show(device, &buffers[0], &error), 0);
	int fence = kms_gl_fence(gl);
	CHECK(fence >= 0);
	CHECK_INT(kms_device_flip(device, &buffers[1], fence), 0);
	CHECK_INT(wait_for_flip(100), 0);
	const uint64_t before = sequence_now();
	fake_gl_signal();
	CHECK_INT((uint32_t)wait_for_flip(100), (uint32_t)before + 1);
	/* One that has signalled costs nothing. */
	CHECK_INT(kms_device_flip(device, &buffers[0], fence), 0);
	CHECK_INT((uint32_t)wait_for_flip(100), (uint32_t)before + 2);
	close(fence);
	CHECK_INT(kms_device_flip(device, &buffers[1], fence), -EINVAL);
	fake_gl.breaks = true;
	CHECK_INT(kms_gl_fence(gl), -1);
	fake_gl.breaks = fake_gl.has_fences = false;
	kms_device_restore(device);
	for (int i = 0; i < 2; i++)
		kms_device_destroy_buffer(device, &buffers[i]);
	close_display();
}

int main(void)
{
	RUN(test_nothing_stays_behind);
	RUN(test_smaller_pictures);
	RUN(test_fence);
	return test_result();
}
