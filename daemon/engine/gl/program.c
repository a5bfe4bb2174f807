/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/program.h"

#include <errno.h>
#include <string.h>

#include "shaders/limits.h"
#include "shaders/shaders.h"

static const struct {
	const char *name, *vertex, *fragment, *compute; /* the last alone, or the two others */
} sources[PROGRAM_KIND_COUNT] = {
	[PROGRAM_PYRAMID] = {"pyramid", shader_tiles_vert, shader_pyramid_frag},
	[PROGRAM_COMPENSATE] = {"compensate", shader_grid_vert, shader_compensate_frag},
	[PROGRAM_COPY] = {"copy", shader_tiles_vert, shader_copy_frag},
	[PROGRAM_WARP] = {"warp", shader_grid_vert, shader_warp_frag},
	[PROGRAM_ANALYSE] = {"analyse", .compute = shader_analyse_comp},
};

static const char *const variant_defines[] = {
	"#define CURVE_GAMMA\n", "#define WEIGHT_ONE\n", "#define NO_COMPENSATION\n", "#define TEAR\n", "#define REAL\n",
};

static const char *header(const struct gl *gl)
{
	if (gl->gles)
		return "#version 310 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n"
			   "precision highp usampler2D;\n";
	return gl->version >= 43 ? "#version 430 core\n" : "#version 330 core\n";
}

static const char *stage_name(GLenum stage)
{
	return stage == GL_VERTEX_SHADER ? "vertex" : stage == GL_FRAGMENT_SHADER ? "fragment" : "compute";
}

static GLuint compile(const struct gl *gl, GLenum stage, const char *name, const char *body, unsigned variant,
					  struct error *error)
{
	const char *parts[8] = {header(gl)};
	GLsizei count = 1;
	for (unsigned i = 0; i < sizeof(variant_defines) / sizeof(variant_defines[0]); i++)
		if (variant & (1u << i))
			parts[count++] = variant_defines[i];
	parts[count++] = shader_limits;
	parts[count++] = body;
	GLuint shader = gl->CreateShader(stage);
	gl->ShaderSource(shader, count, parts, NULL);
	gl->CompileShader(shader);
	GLint ok = GL_FALSE;
	gl->GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
	if (ok)
		return shader;
	char log[400] = "";
	gl->GetShaderInfoLog(shader, sizeof(log), NULL, log);
	error_set(error, -ENOTSUP, "shader %s (%s, variant %u) is refused: %s", name, stage_name(stage), variant, log);
	gl->DeleteShader(shader);
	return 0;
}

/* `second`: 0 for a program of one shader. */
static GLuint link_program(const struct gl *gl, GLuint first, GLuint second, const char *name, struct error *error)
{
	GLuint id = gl->CreateProgram();
	gl->AttachShader(id, first);
	if (second)
		gl->AttachShader(id, second);
	gl->BindAttribLocation(id, ATTRIBUTE_POSITION, "a_position");
	gl->BindAttribLocation(id, ATTRIBUTE_DISPLACEMENT, "a_displacement");
	gl->BindAttribLocation(id, ATTRIBUTE_DEPTH, "a_depth");
	gl->LinkProgram(id);
	GLint ok = GL_FALSE;
	gl->GetProgramiv(id, GL_LINK_STATUS, &ok);
	if (ok)
		return id;
	char log[400] = "";
	gl->GetProgramInfoLog(id, sizeof(log), NULL, log);
	error_set(error, -ENOTSUP, "program %s does not link: %s", name, log);
	gl->DeleteProgram(id);
	return 0;
}

static GLuint build_compute(const struct gl *gl, enum program_kind kind, struct error *error)
{
	const char *name = sources[kind].name;
	GLuint shader = compile(gl, GL_COMPUTE_SHADER, name, sources[kind].compute, 0, error);
	GLuint id = shader ? link_program(gl, shader, 0, name, error) : 0;
	gl->DeleteShader(shader);
	return id;
}

static GLuint build(const struct gl *gl, enum program_kind kind, unsigned variant, struct error *error)
{
	if (sources[kind].compute)
		return build_compute(gl, kind, error);
	const char *name = sources[kind].name;
	const char *vertex_source = variant & VARIANT_WEIGHT_ONE ? shader_rectangle_vert : sources[kind].vertex;
	GLuint vertex = compile(gl, GL_VERTEX_SHADER, name, vertex_source, variant, error);
	GLuint fragment = vertex ? compile(gl, GL_FRAGMENT_SHADER, name, sources[kind].fragment, variant, error) : 0;
	GLuint id = fragment ? link_program(gl, vertex, fragment, name, error) : 0;
	gl->DeleteShader(vertex);
	gl->DeleteShader(fragment);
	return id;
}

const struct program *program_use(struct program_cache *cache, const struct gl *gl, enum program_kind kind,
								  unsigned variant, struct error *error)
{
	struct program *program = &cache->programs[kind][variant];
	if (!program->id) {
		program->id = build(gl, kind, variant, error);
		if (!program->id)
			return NULL;
		gl->UseProgram(program->id);
		gl->Uniform1i(gl->GetUniformLocation(program->id, "u_picture"), UNIT_PICTURE);
		gl->Uniform1i(gl->GetUniformLocation(program->id, "u_low"), UNIT_LOW);
#define X(name) program->name = gl->GetUniformLocation(program->id, "u_" #name);
		PROGRAM_UNIFORMS(X)
#undef X
	}
	gl->UseProgram(program->id);
	return program;
}

void program_cache_finish(struct program_cache *cache, const struct gl *gl)
{
	for (int kind = 0; kind < PROGRAM_KIND_COUNT; kind++)
		for (unsigned variant = 0; variant < VARIANT_COUNT; variant++)
			gl->DeleteProgram(cache->programs[kind][variant].id);
	memset(cache, 0, sizeof(*cache));
}
