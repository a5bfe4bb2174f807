/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pictures of a presenter in GL: a texture each, BGRA8, made in the context that is current. Knows no context. */
#ifndef PURSUIT_TEXTURE_H
#define PURSUIT_TEXTURE_H

#include <GL/glcorearb.h>
#include <stdbool.h>
#include <stdint.h>

struct texture {
	uint32_t name;          /* 0: none */
	uint32_t width, height; /* 0: nothing there */
};

/* What is needed for that. */
struct texture_functions {
	PFNGLGENTEXTURESPROC gen_textures;
	PFNGLBINDTEXTUREPROC bind_texture;
	PFNGLTEXIMAGE2DPROC tex_image;
	PFNGLTEXPARAMETERIPROC tex_parameter;
	PFNGLGETERRORPROC get_error;
};

/* find: looks a function of the context up. False: one is missing. */
bool texture_find_functions(struct texture_functions *gl, void (*(*find)(const char *name))(void));

/* Makes it that size; what was in it is lost if it changes. False: there is no memory, and nothing in it. */
bool texture_resize(struct texture *texture, const struct texture_functions *gl, uint32_t width, uint32_t height);

#endif
