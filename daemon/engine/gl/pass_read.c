/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pixels back to memory, rows top to bottom as they lie: nothing is flipped. */
#include "daemon/engine/gl/executor_gl.h"

static int run(struct engine *engine, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct engine_image *image = engine->job.image;
	const struct target *picture;
	const int result = gl_picture(engine, engine->job.picture, &picture, error);
	if (result < 0)
		return result;
	gl->BindFramebuffer(GL_READ_FRAMEBUFFER, picture->framebuffer);
	const struct readback_image to = {image->data, image->stride, picture->width, picture->height};
	engine->report.bytes_down += 4 * (uint64_t)picture->width * picture->height;
	return readback_run(&gl_of(engine)->readback, gl, &to, error);
}

const struct pass gl_pass_read = {.run = run};
