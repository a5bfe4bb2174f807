/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/texture.h"

#include <stddef.h>
#include <string.h>

bool texture_find_functions(struct texture_functions *gl, void (*(*find)(const char *name))(void))
{
	static const struct {
		const char *name;
		size_t offset;
	} functions[] = {
		{"glGenTextures", offsetof(struct texture_functions, gen_textures)},
		{"glBindTexture", offsetof(struct texture_functions, bind_texture)},
		{"glTexImage2D", offsetof(struct texture_functions, tex_image)},
		{"glTexParameteri", offsetof(struct texture_functions, tex_parameter)},
		{"glGetError", offsetof(struct texture_functions, get_error)},
	};
	for (size_t i = 0; i < sizeof(functions) / sizeof(functions[0]); i++) {
		void (*function)(void) = find(functions[i].name);
		if (!function)
			return false;
		memcpy((char *)gl + functions[i].offset, &function, sizeof(function));
	}
	return true;
}

bool texture_resize(struct texture *texture, const struct texture_functions *gl, uint32_t width, uint32_t height)
{
	if (texture->name && texture->width == width && texture->height == height)
		return true;
	if (!texture->name)
		gl->gen_textures(1, &texture->name);
	/* A lost context has an error for ever. */
	for (int i = 0; i < 8 && gl->get_error() != 0; i++)
		continue;
	gl->bind_texture(GL_TEXTURE_2D, texture->name);
	gl->tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	gl->tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	gl->tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
	/* For an internal format without a size Mesa takes the order in memory from format and type: that of the engine. */
	gl->tex_image(GL_TEXTURE_2D, 0, GL_RGBA, (GLsizei)width, (GLsizei)height, 0, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV,
				  NULL);
	const bool fine = gl->get_error() == 0;
	texture->width = fine ? width : 0;
	texture->height = fine ? height : 0;
	return fine;
}
