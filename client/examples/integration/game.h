/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the little game had before: matrices, shaders, a window. None of it knows of Pursuit. */
#ifndef GAME_H
#define GAME_H

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 640
#define HEIGHT 360
#define CUBES 24
#define GLSL "#version 330 core\n"

struct matrix {
	float m[16]; /* column-major */
};

static inline struct matrix multiply(struct matrix a, struct matrix b)
{
	struct matrix to;
	for (int column = 0; column < 4; column++)
		for (int row = 0; row < 4; row++) {
			to.m[4 * column + row] = 0.0f;
			for (int i = 0; i < 4; i++)
				to.m[4 * column + row] += a.m[4 * i + row] * b.m[4 * column + i];
		}
	return to;
}

static inline struct matrix turn_and_move(float angle, float x, float y, float z)
{
	const float c = cosf(angle), s = sinf(angle);
	return (struct matrix){{c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, x, y, z, 1}};
}

static inline struct matrix perspective(float near, float far)
{
	const float f = 1.5f, aspect = (float)WIDTH / HEIGHT;
	return (struct matrix){{f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0,
							2 * far * near / (near - far), 0}};
}

static inline struct matrix camera_at(double time)
{
	return multiply(perspective(0.1f, 50.0f),
					multiply(turn_and_move(0, 0, -0.4f, -7), turn_and_move((float)time * 0.3f, 0, 0, 0)));
}

static inline struct matrix cube_at(int cube, double time)
{
	const float angle = (float)cube * 6.2831853f / CUBES;
	const float height = 0.6f * sinf((float)time * 2.0f + (float)cube);
	return multiply(turn_and_move(angle, 0, 0, 0), turn_and_move((float)time, 0, height, 3.2f));
}

static inline GLuint compile(GLenum type, const char *source)
{
	const GLuint shader = glCreateShader(type);
	GLint good = 0;
	char log[512];
	glShaderSource(shader, 1, &source, NULL);
	glCompileShader(shader);
	glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
	if (!good) {
		glGetShaderInfoLog(shader, sizeof(log), NULL, log);
		fprintf(stderr, "%s\n", log);
		exit(1);
	}
	return shader;
}

static inline GLuint make_program(const char *vertex, const char *fragment)
{
	const GLuint program = glCreateProgram();
	glAttachShader(program, compile(GL_VERTEX_SHADER, vertex));
	glAttachShader(program, compile(GL_FRAGMENT_SHADER, fragment));
	glLinkProgram(program);
	return program;
}

static inline GLFWwindow *make_window(void)
{
	GLuint vertices;
	if (!glfwInit())
		return NULL;
	glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
	glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
	glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
	GLFWwindow *window = glfwCreateWindow(WIDTH, HEIGHT, "cubes", NULL, NULL);
	if (!window)
		return NULL;
	glfwMakeContextCurrent(window);
	glfwSwapInterval(1);
	glGenVertexArrays(1, &vertices);
	glBindVertexArray(vertices);
	return window;
}

static inline double seconds_of(int count, char **arguments)
{
	return count == 3 && strcmp(arguments[1], "--seconds") == 0 ? atof(arguments[2]) : 1e9;
}

static inline void set_matrix(GLuint program, const char *name, struct matrix matrix)
{
	glUniformMatrix4fv(glGetUniformLocation(program, name), 1, GL_FALSE, matrix.m);
}

/* The corners of a cube from gl_VertexID, 36 of them. */
#define CUBE_GLSL                                                                                                      \
	"const int corners[36] = int[36](0,2,1,1,2,3, 4,5,6,5,7,6, 0,1,4,1,5,4, 2,6,3,3,6,7, 0,4,2,2,4,6, 1,3,5,3,7,5);\n" \
	"vec3 corner() {\n"                                                                                                \
	"	int i = corners[gl_VertexID];\n"                                                                                 \
	"	return vec3(i & 1, (i >> 1) & 1, i >> 2) - 0.5;\n"                                                               \
	"}\n"

/* A texture with detail, so that motion is seen. */
#define SURFACE_GLSL                                                                            \
	"vec3 surface(vec3 p) {\n"                                                                  \
	"	vec3 wave = 0.5 + 0.5 * sin(p * 40.0);\n"                                                 \
	"	return mix(vec3(0.2, 0.3, 0.5), vec3(0.95, 0.8, 0.5), wave.x * wave.y + wave.z * 0.3);\n" \
	"}\n"

#endif
