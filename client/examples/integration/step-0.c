/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Step 0: the game as it was: cubes, a camera that turns, a bar that shows the time. Draws into its window. */
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

int main(int count, char **arguments)
{
	const double seconds = seconds_of(count, arguments);
	GLFWwindow *window = make_window();
	if (!window)
		return 77;
	const GLuint program = make_program(vertex, fragment);
	while (!glfwWindowShouldClose(window) && glfwGetTime() < seconds) {
		const double time = glfwGetTime();
		glEnable(GL_DEPTH_TEST);
		glClearColor(0.05f, 0.06f, 0.08f, 1.0f);
		glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
		draw_cubes(program, time);
		draw_bar(time);
		glfwSwapBuffers(window);
		glfwPollEvents();
	}
	glfwTerminate();
	return 0;
}
