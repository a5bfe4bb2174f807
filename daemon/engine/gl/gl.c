/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/gl.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define PATIENCE_NS UINT64_C(5000000000)

static gl_function find(gl_lookup lookup, const char *name)
{
	static const char *const suffixes[] = {"", "EXT", "KHR", "ARB"};
	for (size_t i = 0; i < sizeof(suffixes) / sizeof(suffixes[0]); i++) {
		char full[96];
		snprintf(full, sizeof(full), "gl%s%s", name, suffixes[i]);
		gl_function function = lookup(full);
		if (function)
			return function;
	}
	return NULL;
}

bool gl_has_extension(const struct gl *gl, const char *name)
{
	GLint count = 0;
	gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
	for (GLint i = 0; i < count; i++) {
		const GLubyte *extension = gl->GetStringi(GL_EXTENSIONS, (GLuint)i);
		if (extension && strcmp((const char *)extension, name) == 0)
			return true;
	}
	return false;
}

static void learn_limits(struct gl *gl)
{
	const char *version = (const char *)gl->GetString(GL_VERSION);
	gl->gles = version && strncmp(version, "OpenGL ES", 9) == 0;
	GLint major = 0, minor = 0, texture = 0, viewport[2] = {0, 0};
	gl->GetIntegerv(GL_MAJOR_VERSION, &major);
	gl->GetIntegerv(GL_MINOR_VERSION, &minor);
	gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
	gl->GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
	gl->version = 10 * major + minor;
	gl->max_size = texture;
	for (int i = 0; i < 2; i++)
		gl->max_size = viewport[i] < gl->max_size ? viewport[i] : gl->max_size;
	gl->pixel_format = GL_RGBA;
	gl->pixel_type = GL_UNSIGNED_BYTE;
	bool functions = gl->GenQueries && gl->DeleteQueries && gl->BeginQuery && gl->EndQuery && gl->GetQueryObjectui64v;
	gl->compute = gl->DispatchCompute && gl->MemoryBarrier && gl->version >= (gl->gles ? 31 : 43);
	if (gl->compute)
		gl->GetIntegerv(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &gl->max_storage);
	gl->timer_queries = functions && (!gl->gles || gl_has_extension(gl, "GL_EXT_disjoint_timer_query"));
}

int gl_load(struct gl *gl, gl_lookup lookup, struct error *error)
{
#define X(name, type)                                  \
	gl->name = (PFNGL##type##PROC)find(lookup, #name); \
	if (!gl->name)                                     \
		return error_set(error, -ENOTSUP, "the renderer has no gl%s", #name);
	GL_FUNCTIONS(X)
#undef X
#define X(name, type) gl->name = (PFNGL##type##PROC)find(lookup, #name);
	GL_OPTIONAL_FUNCTIONS(X)
#undef X
	learn_limits(gl);
	return 0;
}

int gl_wait(const struct gl *gl, GLsync fence, struct error *error)
{
	if (!fence)
		return error_set(error, -EIO, "the context is lost: it gives no fence");
	const GLenum result = gl->ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, PATIENCE_NS);
	if (result == GL_ALREADY_SIGNALED || result == GL_CONDITION_SATISFIED)
		return 0;
	return error_set(error, -EIO, "the context is lost: a fence does not come (0x%x)", result);
}
