/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pixels back to memory, rows top to bottom as they lie: nothing is flipped. */
#include "daemon/engine/gl/executor_gl.h"

static int run(struct engine *engine, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct engine_image *image = engine->job.image;
	const struct target *picture = picture_of(engine, engine->job.picture);
	gl->BindFramebuffer(GL_READ_FRAMEBUFFER, picture->framebuffer);
	gl->PixelStorei(GL_PACK_ROW_LENGTH, (GLint)(image->stride / 4));
	gl->ReadPixels(0, 0, (GLsizei)picture->width, (GLsizei)picture->height, gl->pixel_format, gl->pixel_type,
				   image->data);
	engine->report.bytes_down += 4 * (uint64_t)picture->width * picture->height;
	return 0;
}

const struct pass gl_pass_read = {.run = run};
