/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "gl.h"

#include <stdio.h>
#include <string.h>

static const char header_gl[] = "#version 330 core\n";
static const char header_es[] = "#version 310 es\nprecision highp float;\nprecision highp int;\n"
								"precision highp sampler2DArray;\n";

static bool has_extension(const struct scene_gl *gl, const char *name)
{
	GLint count = 0;
	gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
	for (GLint i = 0; i < count; i++) {
		const char *extension = (const char *)gl->GetStringi(GL_EXTENSIONS, (GLuint)i);
		if (extension && strcmp(extension, name) == 0)
			return true;
	}
	return false;
}

bool scene_gl_init(struct scene_gl *gl, scene_gl_lookup lookup, char *error, size_t error_size)
{
	union {
		void *object;
		void (*function)(void);
	} pointer;
#define SCENE_GL_LOAD(type, name)                                            \
	pointer.object = lookup("gl" #name);                                     \
	if (!pointer.object) {                                                   \
		snprintf(error, error_size, "the context has no function gl" #name); \
		return false;                                                        \
	}                                                                        \
	gl->name = (type)pointer.function;
	SCENE_GL_FUNCTIONS(SCENE_GL_LOAD)
#undef SCENE_GL_LOAD
	const char *version = (const char *)gl->GetString(GL_VERSION);
	if (!version) {
		snprintf(error, error_size, "no GL context is current");
		return false;
	}
	gl->es = strncmp(version, "OpenGL ES", 9) == 0;
	GLint major = 0, minor = 0;
	gl->GetIntegerv(GL_MAJOR_VERSION, &major);
	gl->GetIntegerv(GL_MINOR_VERSION, &minor);
	if (major * 10 + minor < (gl->es ? 31 : 33)) {
		snprintf(error, error_size, "the context is %s; the scenes need GL 3.3 core or GLES 3.1", version);
		return false;
	}
	if (gl->es && major * 10 + minor < 32 && !has_extension(gl, "GL_EXT_color_buffer_float")) {
		snprintf(error, error_size, "the GLES context lacks GL_EXT_color_buffer_float, which depth and motion need");
		return false;
	}
	return true;
}

static GLuint compile(const struct scene_gl *gl, GLenum kind, const char *source, char *error, size_t error_size)
{
	GLuint shader = gl->CreateShader(kind);
	const char *sources[2] = {gl->es ? header_es : header_gl, source};
	GLint ok = 0;
	gl->ShaderSource(shader, 2, sources, NULL);
	gl->CompileShader(shader);
	gl->GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
	if (ok)
		return shader;
	char log[512] = "";
	gl->GetShaderInfoLog(shader, sizeof(log), NULL, log);
	snprintf(error, error_size, "a scene's %s shader does not compile: %s",
			 kind == GL_VERTEX_SHADER ? "vertex" : "fragment", log);
	gl->DeleteShader(shader);
	return 0;
}

GLuint scene_gl_program(const struct scene_gl *gl, const char *vertex, const char *fragment, char *error,
						size_t error_size)
{
	GLuint shaders[2] = {compile(gl, GL_VERTEX_SHADER, vertex, error, error_size), 0};
	if (!shaders[0])
		return 0;
	shaders[1] = compile(gl, GL_FRAGMENT_SHADER, fragment, error, error_size);
	if (!shaders[1]) {
		gl->DeleteShader(shaders[0]);
		return 0;
	}
	GLuint program = gl->CreateProgram();
	GLint ok = 0;
	for (int i = 0; i < 2; i++)
		gl->AttachShader(program, shaders[i]);
	gl->LinkProgram(program);
	for (int i = 0; i < 2; i++)
		gl->DeleteShader(shaders[i]);
	gl->GetProgramiv(program, GL_LINK_STATUS, &ok);
	if (ok)
		return program;
	char log[512] = "";
	gl->GetProgramInfoLog(program, sizeof(log), NULL, log);
	snprintf(error, error_size, "a scene's program does not link: %s", log);
	gl->DeleteProgram(program);
	return 0;
}
