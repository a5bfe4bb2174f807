/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Step 4: the bar goes into a layer of its own, so that it is neither warped nor blurred, and the game begins each
 * frame when the daemon says, for the least latency.
 */
#include "game.h"

#include <pursuit.h>
#include <time.h>

static const char vertex[] = GLSL CUBE_GLSL "uniform mat4 transform, transform_before;\n"
											"out vec3 place;\n"
											"out vec4 now, before;\n"
											"void main() {\n"
											"	place = corner();\n"
											"	now = transform * vec4(place, 1.0);\n"
											"	before = transform_before * vec4(place, 1.0);\n"
											"	gl_Position = now;\n"
											"}\n";
static const char fragment[] = GLSL SURFACE_GLSL "in vec3 place;\n"
												 "in vec4 now, before;\n"
												 "uniform vec2 half_size;\n"
												 "layout(location = 0) out vec4 color;\n"
												 "layout(location = 1) out vec2 motion;\n"
												 "void main() {\n"
												 "	color = vec4(surface(place), 1.0);\n"
												 "	motion = (now.xy / now.w - before.xy / before.w) * half_size;\n"
												 "}\n";

struct targets {
	GLuint framebuffer, color, motion, depth;
	GLuint ui_framebuffer, ui;
};

static GLuint make_texture(GLenum internal, GLenum format, GLenum attachment)
{
	GLuint texture;
	glGenTextures(1, &texture);
	glBindTexture(GL_TEXTURE_2D, texture);
	glTexImage2D(GL_TEXTURE_2D, 0, (GLint)internal, WIDTH, HEIGHT, 0, format, GL_FLOAT, NULL);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture, 0);
	return texture;
}

static struct targets make_targets(void)
{
	const GLenum buffers[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
	struct targets targets;
	glGenFramebuffers(1, &targets.framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer);
	targets.color = make_texture(GL_RGBA8, GL_RGBA, GL_COLOR_ATTACHMENT0);
	targets.motion = make_texture(GL_RG16F, GL_RG, GL_COLOR_ATTACHMENT1);
	targets.depth = make_texture(GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_DEPTH_ATTACHMENT);
	glDrawBuffers(2, buffers);
	glGenFramebuffers(1, &targets.ui_framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, targets.ui_framebuffer);
	targets.ui = make_texture(GL_RGBA8, GL_RGBA, GL_COLOR_ATTACHMENT0);
	return targets;
}

static void draw_cubes(GLuint program, double time, double time_before)
{
	const struct matrix camera = camera_at(time), camera_before = camera_at(time_before);
	glUseProgram(program);
	glUniform2f(glGetUniformLocation(program, "half_size"), WIDTH / 2.0f, HEIGHT / 2.0f);
	for (int cube = 0; cube < CUBES; cube++) {
		set_matrix(program, "transform", multiply(camera, cube_at(cube, time)));
		set_matrix(program, "transform_before", multiply(camera_before, cube_at(cube, time_before)));
		glDrawArrays(GL_TRIANGLES, 0, 36);
	}
}

/* The background stands still: its motion is 0. */
static void clear(void)
{
	const float background[] = {0.05f, 0.06f, 0.08f, 1.0f}, still[] = {0, 0, 0, 0}, far = 1.0f;
	glClearBufferfv(GL_COLOR, 0, background);
	glClearBufferfv(GL_COLOR, 1, still);
	glClearBufferfv(GL_DEPTH, 0, &far);
}

static void draw_bar(double time)
{
	glEnable(GL_SCISSOR_TEST);
	glScissor(20, 20, 20 + (int)(time * 60) % 200, 12);
	glClearColor(1.0f, 0.9f, 0.2f, 1.0f);
	glClear(GL_COLOR_BUFFER_BIT);
	glDisable(GL_SCISSOR_TEST);
}

/* Premultiplied alpha: nothing is (0, 0, 0, 0). */
static void draw_ui(const struct targets *targets, double time)
{
	const float nothing[] = {0, 0, 0, 0};
	glBindFramebuffer(GL_FRAMEBUFFER, targets->ui_framebuffer);
	glClearBufferfv(GL_COLOR, 0, nothing);
	draw_bar(time);
}

static void show(const struct targets *targets)
{
	glBindFramebuffer(GL_READ_FRAMEBUFFER, targets->framebuffer);
	glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
	glBlitFramebuffer(0, 0, WIDTH, HEIGHT, 0, 0, WIDTH, HEIGHT, GL_COLOR_BUFFER_BIT, GL_NEAREST);
	glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

static void *lookup(const char *name)
{
	return (void *)glfwGetProcAddress(name);
}

static struct pursuit_stream *open_stream(void)
{
	const struct pursuit_stream_params params = {
		.width = WIDTH,
		.height = HEIGHT,
		.color_format = PURSUIT_COLOR_RGBA8,
		.depth_format = PURSUIT_DEPTH_FLOAT32,
		.motion_format = PURSUIT_MOTION_FLOAT16,
		.ui_format = PURSUIT_UI_RGBA8,
		.name = "cubes",
	};
	return pursuit_open(&params);
}

/* GL has its first row at the bottom and y up; the shim turns both. */
static void submit(struct pursuit_gl *gl, const struct targets *targets, uint64_t time_ns)
{
	const struct pursuit_gl_textures textures = {
		.color = targets->color,
		.depth = targets->depth,
		.motion = targets->motion,
		.ui = targets->ui,
		.bottom_up = 1,
		.motion_y_up = 1,
	};
	const struct pursuit_frame frame = {.time_ns = time_ns};
	pursuit_gl_submit(gl, &textures, &frame);
}

static uint64_t now_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

int main(int count, char **arguments)
{
	const double seconds = seconds_of(count, arguments);
	GLFWwindow *window = make_window();
	if (!window)
		return 77;
	const GLuint program = make_program(vertex, fragment);
	const struct targets targets = make_targets();
	struct pursuit_stream *stream = open_stream();
	struct pursuit_gl *gl = pursuit_gl_create(stream, lookup);
	double time_before = 0.0;
	while (!glfwWindowShouldClose(window) && glfwGetTime() < seconds) {
		pursuit_wait_next(stream, 20000000u);
		const uint64_t time_ns = now_ns();
		const double time = glfwGetTime();
		glBindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer);
		glEnable(GL_DEPTH_TEST);
		clear();
		draw_cubes(program, time, time_before);
		time_before = time;
		draw_ui(&targets, time);
		submit(gl, &targets, time_ns);
		show(&targets);
		draw_bar(time);
		glfwSwapBuffers(window);
		glfwPollEvents();
	}
	pursuit_gl_destroy(&gl);
	pursuit_close(&stream);
	glfwTerminate();
	return 0;
}
