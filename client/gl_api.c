/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "client/gl_api.h"

#include <string.h>

/* ISO C has no cast from an object pointer to a function pointer; POSIX gives them one representation. */
static bool load_function(void *function, const char *name, pursuit_gl_lookup lookup)
{
	void *address = lookup(name);
	memcpy(function, &address, sizeof(address));
	return address != NULL;
}

static bool load_functions(struct shim_gl_api *api, pursuit_gl_lookup lookup)
{
	bool all = true;
#define LOAD(result, name, arguments) all = load_function(&api->name, "gl" #name, lookup) && all;
	SHIM_GL_FUNCTIONS(LOAD)
#undef LOAD
	return all;
}

static bool has_extension(const struct shim_gl_api *api, const char *name)
{
	int32_t count = 0;

	api->GetIntegerv(SHIM_GL_NUM_EXTENSIONS, &count);
	for (int32_t i = 0; i < count; i++) {
		const uint8_t *extension = api->GetStringi(SHIM_GL_EXTENSIONS, (uint32_t)i);
		if (extension && strcmp((const char *)extension, name) == 0) {
			return true;
		}
	}
	return false;
}

bool shim_gl_api_load(struct shim_gl_api *api, pursuit_gl_lookup lookup)
{
	int32_t major = 0, minor = 0;

	memset(api, 0, sizeof(*api));
	if (!load_functions(api, lookup)) {
		return false;
	}
	const char *version = (const char *)api->GetString(SHIM_GL_VERSION);
	if (!version) {
		return false;
	}
	api->es = strncmp(version, "OpenGL ES", 9) == 0;
	api->GetIntegerv(SHIM_GL_MAJOR_VERSION, &major);
	api->GetIntegerv(SHIM_GL_MINOR_VERSION, &minor);
	int number = major * 10 + minor;
	if (number < (api->es ? 30 : 32)) {
		return false;
	}
	if (!api->es) {
		load_function(&api->ClampColor, "glClampColor", lookup);
	}
	api->float_targets = !api->es || number >= 32 || has_extension(api, "GL_EXT_color_buffer_float");
	return true;
}
