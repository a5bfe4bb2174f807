/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pixels to a texture of somebody else's, where they stay in GL; rows as they lie. */
#include <errno.h>

#include "daemon/engine/gl/executor_gl.h"

/* A GPU that needs longer for a picture is not coming back. */
#define PATIENCE_NS UINT64_C(5000000000)

/* The one who shows it has another context, and the pacer wants to know when it was done. */
static int wait_until_done(const struct gl *gl, struct error *error)
{
	const GLsync fence = gl->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
	if (!fence)
		return error_set(error, -EIO, "the context is lost: it gives no fence");
	const GLenum result = gl->ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, PATIENCE_NS);
	gl->DeleteSync(fence);
	if (result == GL_ALREADY_SIGNALED || result == GL_CONDITION_SATISFIED)
		return 0;
	return error_set(error, -EIO, "the context is lost: a fence does not come (0x%x)", result);
}

static int run(struct engine *engine, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct target *picture = picture_of(engine, engine->job.picture);
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
	return wait_until_done(gl, error);
}

const struct pass gl_pass_copy = {.run = run};
