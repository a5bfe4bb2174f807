/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Draws a picture in CPU memory, or a texture of its share group, into the framebuffer of the GL context that is
 * current (OpenGL 3.0): as large as fits, its shape kept, black around it.
 */
#ifndef PURSUIT_BLIT_H
#define PURSUIT_BLIT_H

#include <GL/glcorearb.h>
#include <stdint.h>

#include "daemon/error.h"
#include "daemon/present/presenter.h"

struct blit {
	GLuint texture, framebuffer;
	GLuint shared_framebuffer; /* of textures that are not ours */
	uint32_t width, height;    /* of the texture */
	PFNGLGENTEXTURESPROC gen_textures;
	PFNGLDELETETEXTURESPROC delete_textures;
	PFNGLBINDTEXTUREPROC bind_texture;
	PFNGLTEXIMAGE2DPROC tex_image;
	PFNGLTEXSUBIMAGE2DPROC tex_sub_image;
	PFNGLTEXPARAMETERIPROC tex_parameter;
	PFNGLPIXELSTOREIPROC pixel_store;
	PFNGLGENFRAMEBUFFERSPROC gen_framebuffers;
	PFNGLDELETEFRAMEBUFFERSPROC delete_framebuffers;
	PFNGLBINDFRAMEBUFFERPROC bind_framebuffer;
	PFNGLFRAMEBUFFERTEXTURE2DPROC framebuffer_texture;
	PFNGLBLITFRAMEBUFFERPROC blit_framebuffer;
	PFNGLCLEARCOLORPROC clear_color;
	PFNGLCLEARPROC clear;
	PFNGLFINISHPROC finish;
};

typedef void (*blit_function)(void);

/* find: looks a function of the context up. 0 or -ENOSYS with a sentence. */
int blit_init(struct blit *blit, blit_function (*find)(const char *name), struct error *error);
void blit_finish(struct blit *blit);

/*
 * image NULL: all black. The image's memory is not needed any more when it returns; a texture, which others have
 * finished, must stay until blit_wait(), or the swap that follows is known to be over.
 */
void blit_draw(struct blit *blit, const struct presenter_image *image, uint32_t window_width, uint32_t window_height);
/* Waits until all is drawn. */
void blit_wait(struct blit *blit);

#endif
