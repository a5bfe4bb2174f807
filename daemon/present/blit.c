/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/blit.h"

#include <errno.h>
#include <stddef.h>
#include <string.h>

#include "daemon/present/rectangle.h"

int blit_init(struct blit *blit, blit_function (*find)(const char *name), struct error *error)
{
	static const struct {
		const char *name;
		size_t offset;
	} functions[] = {
		{"glGenTextures", offsetof(struct blit, gen_textures)},
		{"glDeleteTextures", offsetof(struct blit, delete_textures)},
		{"glBindTexture", offsetof(struct blit, bind_texture)},
		{"glTexImage2D", offsetof(struct blit, tex_image)},
		{"glTexSubImage2D", offsetof(struct blit, tex_sub_image)},
		{"glTexParameteri", offsetof(struct blit, tex_parameter)},
		{"glPixelStorei", offsetof(struct blit, pixel_store)},
		{"glGenFramebuffers", offsetof(struct blit, gen_framebuffers)},
		{"glDeleteFramebuffers", offsetof(struct blit, delete_framebuffers)},
		{"glBindFramebuffer", offsetof(struct blit, bind_framebuffer)},
		{"glFramebufferTexture2D", offsetof(struct blit, framebuffer_texture)},
		{"glBlitFramebuffer", offsetof(struct blit, blit_framebuffer)},
		{"glClearColor", offsetof(struct blit, clear_color)},
		{"glClear", offsetof(struct blit, clear)},
		{"glFinish", offsetof(struct blit, finish)},
	};
	memset(blit, 0, sizeof(*blit));
	for (size_t i = 0; i < sizeof(functions) / sizeof(functions[0]); i++) {
		const blit_function function = find(functions[i].name);
		if (!function)
			return error_set(error, -ENOSYS, "glfw: the context has no %s", functions[i].name);
		memcpy((char *)blit + functions[i].offset, &function, sizeof(function));
	}
	blit->gen_textures(1, &blit->texture);
	blit->gen_framebuffers(1, &blit->framebuffer);
	blit->gen_framebuffers(1, &blit->shared_framebuffer);
	blit->bind_texture(GL_TEXTURE_2D, blit->texture);
	blit->tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	blit->tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	return 0;
}

void blit_finish(struct blit *blit)
{
	if (blit->delete_textures)
		blit->delete_textures(1, &blit->texture);
	if (blit->delete_framebuffers) {
		blit->delete_framebuffers(1, &blit->framebuffer);
		blit->delete_framebuffers(1, &blit->shared_framebuffer);
	}
}

/* What others drew into a texture is only sure to be seen once it is attached anew. */
static void attach(struct blit *blit, const struct presenter_image *image)
{
	blit->bind_framebuffer(GL_READ_FRAMEBUFFER, blit->shared_framebuffer);
	blit->framebuffer_texture(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, image->texture, 0);
}

static void upload(struct blit *blit, const struct presenter_image *image)
{
	blit->bind_framebuffer(GL_READ_FRAMEBUFFER, blit->framebuffer);
	if (blit->width != image->width || blit->height != image->height) {
		blit->width = image->width;
		blit->height = image->height;
		blit->tex_image(GL_TEXTURE_2D, 0, GL_RGBA8, (GLsizei)image->width, (GLsizei)image->height, 0, GL_BGRA,
						GL_UNSIGNED_INT_8_8_8_8_REV, NULL);
		blit->framebuffer_texture(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, blit->texture, 0);
	}
	blit->pixel_store(GL_UNPACK_ROW_LENGTH, (GLint)(image->stride / 4));
	blit->tex_sub_image(GL_TEXTURE_2D, 0, 0, 0, (GLsizei)image->width, (GLsizei)image->height, GL_BGRA,
						GL_UNSIGNED_INT_8_8_8_8_REV, image->data);
}

void blit_draw(struct blit *blit, const struct presenter_image *image, uint32_t window_width, uint32_t window_height)
{
	blit->bind_framebuffer(GL_DRAW_FRAMEBUFFER, 0);
	blit->clear_color(0.0f, 0.0f, 0.0f, 1.0f);
	if (!image) {
		blit->clear(GL_COLOR_BUFFER_BIT);
		return;
	}
	const struct rectangle to = rectangle_fit(image->width, image->height, window_width, window_height);
	const bool same_size = to.width == image->width && to.height == image->height;
	if (to.width != window_width || to.height != window_height)
		blit->clear(GL_COLOR_BUFFER_BIT);
	if (image->texture)
		attach(blit, image);
	else
		upload(blit, image);
	/* Rows of the picture go from top to bottom, those of GL upwards. */
	const GLint top = (GLint)(window_height - to.y);
	blit->blit_framebuffer(0, 0, (GLint)image->width, (GLint)image->height, (GLint)to.x, top, (GLint)(to.x + to.width),
						   top - (GLint)to.height, GL_COLOR_BUFFER_BIT, same_size ? GL_NEAREST : GL_LINEAR);
}

void blit_wait(struct blit *blit)
{
	blit->finish();
}
