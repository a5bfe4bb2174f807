/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pixels to a texture of somebody else's, where they stay in GL; rows as they lie. */
#include <errno.h>

#include "daemon/engine/gl/executor_gl.h"

static int bind_texture(struct engine *engine, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const uint32_t texture = engine->job.image->texture;
	GLuint *framebuffer = &gl_of(engine)->copy_framebuffer;
	if (!*framebuffer)
		gl->GenFramebuffers(1, framebuffer);
	gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, *framebuffer);
	gl->FramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
	const GLenum status = gl->CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER);
	if (status == GL_FRAMEBUFFER_COMPLETE)
		return 0;
	return error_set(error, -EINVAL, "texture %u cannot be drawn to (0x%x)", texture, status);
}

/* The tiles that the texture does not have; how many bytes. */
static uint64_t copy(const struct engine *engine)
{
	const struct gl *gl = table_of(engine);
	const GLint x = (GLint)engine->job.image->texture_x, y = (GLint)engine->job.image->texture_y;
	struct bounds bounds = {0};
	uint64_t bytes = 0;
	while (tiles_next_bounds(&gl_of(engine)->leaving, GL_TILES_OF_CALL, &bounds)) {
		const GLint left = (GLint)bounds.left, top = (GLint)bounds.top;
		const GLint right = (GLint)bounds.right, bottom = (GLint)bounds.bottom;
		gl->BlitFramebuffer(left, top, right, bottom, x + left, y + top, x + right, y + bottom, GL_COLOR_BUFFER_BIT,
							GL_NEAREST);
		bytes += 4 * (uint64_t)(bounds.right - bounds.left) * (bounds.bottom - bounds.top);
	}
	return bytes;
}

static int run(struct engine *engine, struct error *error)
{
	const struct target *picture;
	struct sheet sheet;
	int result = gl_picture(engine, engine->job.picture, &picture, error);
	if (result == 0)
		result = bind_texture(engine, error);
	if (result == 0)
		result = gl_open_image(engine, &sheet, error);
	if (result < 0)
		return result;
	table_of(engine)->BindFramebuffer(GL_READ_FRAMEBUFFER, picture->framebuffer);
	gl_close_image(engine, &sheet, copy(engine));
	/* The one who shows it has another context, and the pacer wants to know when it was done. */
	if (!engine->job.image->unfinished)
		return engine->executor->ops->finish(engine->executor, error);
	table_of(engine)->Flush();
	return 0;
}

const struct pass gl_pass_copy = {.run = run};
