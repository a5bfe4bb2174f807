/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What the shim costs a game a frame: acquire and submit, the caller's own
 * writing of the pixels apart, and the GL helper. Lines of `name value unit`.
 *
 * Frames carry BGRA8 colour, 32-bit depth and half float motion: 12 bytes a
 * pixel. The daemon is the tests' own, in this process, and takes each frame.
 */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/client/fake_daemon.h"
#include "tests/client/harness.h"

#ifdef BENCH_GL
#include <GLES3/gl32.h>

#include "tests/client/egl_context.h"
#endif

#define FRAMES 200

/* What one frame took in each part. */
struct samples {
	const char *name;
	double us[FRAMES];
};

static uint64_t clock_ns(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static void print_samples(struct samples *samples, uint32_t width, uint32_t height)
{
	qsort(samples->us, FRAMES, sizeof(*samples->us), compare);
	printf("client.%s.%ux%u.median %.2f us\n", samples->name, width, height, samples->us[FRAMES / 2]);
	printf("client.%s.%ux%u.p99 %.2f us\n", samples->name, width, height, samples->us[FRAMES * 99 / 100]);
}

static struct pursuit_stream *open_sized(uint32_t width, uint32_t height)
{
	struct pursuit_stream_params params = {
		.width = width,
		.height = height,
		.depth_format = PURSUIT_DEPTH_FLOAT32,
		.motion_format = PURSUIT_MOTION_FLOAT16,
		.socket_path = harness.path,
	};
	return pursuit_open(&params);
}

static void write_planes(const struct pursuit_frame *frame, const uint8_t *pixels)
{
	memcpy(frame->color.data, pixels, frame->color.stride * frame->color.height);
	memcpy(frame->depth.data, pixels, frame->depth.stride * frame->depth.height);
	memcpy(frame->motion.data, pixels, frame->motion.stride * frame->motion.height);
}

static void bench_memory(const char *name, const char *copy_name, uint32_t width, uint32_t height, bool attached)
{
	struct samples shim = {.name = name}, copy = {.name = copy_name};
	struct fake_daemon daemon;
	uint8_t *pixels = calloc((size_t)width * height, 4);

	if (!pixels || (attached && !fake_start(&daemon, harness.path, FAKE_GOOD))) {
		exit(1);
	}
	struct pursuit_stream *stream = open_sized(width, height);
	if (attached && !attach(stream, &daemon)) {
		exit(1);
	}
	for (int i = -20; i < FRAMES; i++) { /* the first ones fault the pages in */
		uint64_t begin = clock_ns();
		struct pursuit_frame *frame = pursuit_acquire(stream);
		uint64_t acquired = clock_ns();
		write_planes(frame, pixels);
		uint64_t written = clock_ns();
		pursuit_submit(stream, frame);
		uint64_t end = clock_ns();
		if (i >= 0) {
			shim.us[i] = (double)(acquired - begin + end - written) * 1e-3;
			copy.us[i] = (double)(written - acquired) * 1e-3;
		}
		if (attached) {
			fake_take(&daemon, NULL);
		}
	}
	print_samples(&shim, width, height);
	if (attached) {
		print_samples(&copy, width, height);
	}
	pursuit_close(&stream);
	if (attached) {
		fake_stop(&daemon, true);
	}
	free(pixels);
}

#ifdef BENCH_GL
static GLuint make_texture(GLenum internal, uint32_t width, uint32_t height)
{
	GLuint texture = 0;
	glGenTextures(1, &texture);
	glBindTexture(GL_TEXTURE_2D, texture);
	glTexStorage2D(GL_TEXTURE_2D, 1, internal, (GLsizei)width, (GLsizei)height);
	return texture;
}

static void bench_textures(const char *name, uint32_t width, uint32_t height)
{
	struct samples samples = {.name = name};
	struct fake_daemon daemon;

	if (!fake_start(&daemon, harness.path, FAKE_GOOD)) {
		exit(1);
	}
	struct pursuit_stream *stream = open_sized(width, height);
	struct pursuit_gl *gl = pursuit_gl_create(stream, egl_context_lookup);
	struct pursuit_gl_textures textures = {
		.color = make_texture(GL_RGBA8, width, height),
		.depth = make_texture(GL_R32F, width, height),
		.motion = make_texture(GL_RG16F, width, height),
		.bottom_up = 1,
		.motion_y_up = 1,
	};
	if (!gl || !attach(stream, &daemon)) {
		exit(1);
	}
	for (int i = -10; i < FRAMES; i++) {
		struct pursuit_frame frame = {.time_ns = clock_ns()};
		uint64_t begin = clock_ns();
		pursuit_gl_submit(gl, &textures, &frame);
		uint64_t end = clock_ns();
		if (i >= 0) {
			samples.us[i] = (double)(end - begin) * 1e-3;
		}
		fake_take(&daemon, NULL);
	}
	print_samples(&samples, width, height);
	struct pursuit_status status = status_of(stream);
	printf("client.%s.%ux%u.copied %.0f bytes\n", name, width, height,
		   (double)status.bytes_copied / (double)status.published);
	glDeleteTextures(3, (const GLuint[]){textures.color, textures.depth, textures.motion});
	pursuit_gl_destroy(&gl);
	pursuit_close(&stream);
	fake_stop(&daemon, true);
}

static void bench_gl(const char *name, bool es)
{
	if (!egl_context_start(es)) {
		return;
	}
	printf("# %s: %s, %s\n", name, (const char *)glGetString(GL_VERSION), (const char *)glGetString(GL_RENDERER));
	bench_textures(name, 640, 360);
	bench_textures(name, 1920, 1080);
	egl_context_finish();
}
#else
static void bench_gl(const char *name, bool es)
{
	printf("# %s: built without EGL\n", name);
}
#endif

int main(void)
{
	if (!harness_start()) {
		return 1;
	}
	bench_memory("submit", "caller-copy", 640, 360, true);
	bench_memory("submit", "caller-copy", 1920, 1080, true);
	bench_memory("submit-no-daemon", NULL, 1920, 1080, false);
	bench_gl("gl-submit-core", false);
	bench_gl("gl-submit-es", true);
	harness_finish();
	return 0;
}
