/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A picture made in memory to the GPU, as a whole. */
#include "daemon/engine/gl/executor_gl.h"

static int run(struct engine *engine, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct bitmap *from = &engine->pixels.shown;
	struct target *shown = picture_of(engine, PICTURE_SHOWN);
	int result = gl_shown_begin(engine, error);
	if (result < 0)
		return result;
	tiles_mark_all(&gl_of(engine)->shown.written);
	gl->ActiveTexture(GL_TEXTURE0);
	gl->BindTexture(GL_TEXTURE_2D, shown->texture);
	gl->TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, (GLsizei)from->width, (GLsizei)from->height, gl->pixel_format,
					  gl->pixel_type, from->data);
	gl_shown_end(engine);
	engine->report.bytes_up += 4 * (uint64_t)from->width * from->height;
	return 0;
}

const struct pass gl_pass_put = {.run = run};
