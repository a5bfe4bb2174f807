/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pixels to a texture of somebody else's, where they stay in GL; rows as they lie. */
#include <errno.h>

#include "daemon/engine/gl/executor_gl.h"

static int run(struct engine *engine, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct target *picture;
	const int result = gl_picture(engine, engine->job.picture, &picture, error);
	if (result < 0)
		return result;
	const GLint width = (GLint)picture->width, height = (GLint)picture->height;
	GLuint *framebuffer = &gl_of(engine)->copy_framebuffer;
	if (!*framebuffer)
		gl->GenFramebuffers(1, framebuffer);
	gl->BindFramebuffer(GL_READ_FRAMEBUFFER, picture->framebuffer);
	gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, *framebuffer);
	gl->FramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, engine->job.image->texture, 0);
	const GLenum status = gl->CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER);
	if (status != GL_FRAMEBUFFER_COMPLETE)
		return error_set(error, -EINVAL, "texture %u cannot be drawn to (0x%x)", engine->job.image->texture, status);
	const GLint x = (GLint)engine->job.image->texture_x, y = (GLint)engine->job.image->texture_y;
	gl->BlitFramebuffer(0, 0, width, height, x, y, x + width, y + height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
	/* The one who shows it has another context, and the pacer wants to know when it was done. */
	if (!engine->job.image->unfinished)
		return engine->executor->ops->finish(engine->executor, error);
	gl->Flush();
	return 0;
}

const struct pass gl_pass_copy = {.run = run};
