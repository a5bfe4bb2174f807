/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/target.h"

#include <errno.h>

static void make_texture(struct target *target, const struct gl *gl, uint32_t width, uint32_t height)
{
	gl->GenTextures(1, &target->texture);
	gl->ActiveTexture(GL_TEXTURE0);
	gl->BindTexture(GL_TEXTURE_2D, target->texture);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
	/*
	 * Without data, but format and type matter: for an internal format without a size Mesa takes the order in memory
	 * from them, so that pixels go in and out as they are.
	 */
	gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, (GLsizei)width, (GLsizei)height, 0, gl->pixel_format, gl->pixel_type,
				   NULL);
}

int target_resize(struct target *target, const struct gl *gl, uint32_t width, uint32_t height, struct error *error)
{
	if (target->width == width && target->height == height)
		return 0;
	target_finish(target, gl);
	while (gl->GetError() != GL_NO_ERROR)
		continue;
	make_texture(target, gl, width, height);
	gl->GenFramebuffers(1, &target->framebuffer);
	gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
	gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target->texture, 0);
	GLenum status = gl->CheckFramebufferStatus(GL_FRAMEBUFFER);
	GLenum code = gl->GetError();
	if (status != GL_FRAMEBUFFER_COMPLETE || code != GL_NO_ERROR) {
		target_finish(target, gl);
		return error_set(error, -ENOMEM, "the renderer has no room for a picture of %u x %u (0x%x, 0x%x)", width,
						 height, status, code);
	}
	target->width = width;
	target->height = height;
	return 0;
}

void target_finish(struct target *target, const struct gl *gl)
{
	gl->DeleteFramebuffers(1, &target->framebuffer);
	gl->DeleteTextures(1, &target->texture);
	*target = (struct target){0};
}

uint64_t target_bytes(const struct target *target)
{
	return 4 * (uint64_t)target->width * target->height;
}

void target_draw_to(const struct target *target, const struct gl *gl)
{
	gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
	gl->Viewport(0, 0, (GLsizei)target->width, (GLsizei)target->height);
}

void target_copy(const struct target *from, const struct target *to, const struct gl *gl)
{
	GLint width = (GLint)to->width, height = (GLint)to->height;
	gl->BindFramebuffer(GL_READ_FRAMEBUFFER, from->framebuffer);
	gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, to->framebuffer);
	gl->BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
	target_draw_to(to, gl);
}
