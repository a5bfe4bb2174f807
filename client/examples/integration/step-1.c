/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Step 1: the game draws into textures, colour and depth, and copies the colour to its window. */
#include "game.h"

static const char vertex[] = GLSL CUBE_GLSL "uniform mat4 transform;\n"
											"out vec3 place;\n"
											"void main() {\n"
											"	place = corner();\n"
											"	gl_Position = transform * vec4(place, 1.0);\n"
											"}\n";
static const char fragment[] = GLSL SURFACE_GLSL "in vec3 place;\n"
												 "layout(location = 0) out vec4 color;\n"
												 "void main() {\n"
												 "	color = vec4(surface(place), 1.0);\n"
												 "}\n";

struct targets {
	GLuint framebuffer, color, depth;
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
	struct targets targets;
	glGenFramebuffers(1, &targets.framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer);
	targets.color = make_texture(GL_RGBA8, GL_RGBA, GL_COLOR_ATTACHMENT0);
	targets.depth = make_texture(GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_DEPTH_ATTACHMENT);
	return targets;
}

static void draw_cubes(GLuint program, double time)
{
	const struct matrix camera = camera_at(time);
	glUseProgram(program);
	for (int cube = 0; cube < CUBES; cube++) {
		set_matrix(program, "transform", multiply(camera, cube_at(cube, time)));
		glDrawArrays(GL_TRIANGLES, 0, 36);
	}
}

static void draw_bar(double time)
{
	glEnable(GL_SCISSOR_TEST);
	glScissor(20, 20, 20 + (int)(time * 60) % 200, 12);
	glClearColor(1.0f, 0.9f, 0.2f, 1.0f);
	glClear(GL_COLOR_BUFFER_BIT);
	glDisable(GL_SCISSOR_TEST);
}

static void show(const struct targets *targets)
{
	glBindFramebuffer(GL_READ_FRAMEBUFFER, targets->framebuffer);
	glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
	glBlitFramebuffer(0, 0, WIDTH, HEIGHT, 0, 0, WIDTH, HEIGHT, GL_COLOR_BUFFER_BIT, GL_NEAREST);
	glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

int main(int count, char **arguments)
{
	const double seconds = seconds_of(count, arguments);
	GLFWwindow *window = make_window();
	if (!window)
		return 77;
	const GLuint program = make_program(vertex, fragment);
	const struct targets targets = make_targets();
	while (!glfwWindowShouldClose(window) && glfwGetTime() < seconds) {
		const double time = glfwGetTime();
		glBindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer);
		glEnable(GL_DEPTH_TEST);
		glClearColor(0.05f, 0.06f, 0.08f, 1.0f);
		glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
		draw_cubes(program, time);
		show(&targets);
		draw_bar(time);
		glfwSwapBuffers(window);
		glfwPollEvents();
	}
	glfwTerminate();
	return 0;
}
