/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The UI layer over everything else, in code values, never warped or blurred. */
#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>

#include "shaders/limits.h"

static const char *prepare(struct engine *engine)
{
	return bounds_empty(&engine->ui_bounds) ? "absent" : NULL;
}

static int run(struct engine *engine, struct error *error)
{
	const struct gl *gl = table_of(engine);
	struct target *shown = picture_of(engine, PICTURE_SHOWN);
	if (engine->job.picture != PICTURE_SHOWN) {
		const struct target *picture;
		gl_of(engine)->shown.holds = false;
		int result = target_resize(shown, gl, engine->width, engine->height, error);
		if (result == 0)
			result = gl_picture(engine, engine->job.picture, &picture, error);
		if (result < 0)
			return result;
		target_copy(picture, shown, gl);
	}
	if (!program_use(&gl_of(engine)->programs, gl, PROGRAM_UI, 0, error))
		return -EIO;
	const struct bounds *bounds = &engine->ui_bounds;
	target_draw_to(shown, gl);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	gl->BindTexture(GL_TEXTURE_2D, picture_of(engine, PICTURE_UI)->texture);
	gl->BindVertexArray(gl_of(engine)->no_attributes);
	gl->Enable(GL_SCISSOR_TEST);
	gl->Scissor((GLint)bounds->left, (GLint)bounds->top, (GLsizei)(bounds->right - bounds->left),
				(GLsizei)(bounds->bottom - bounds->top));
	gl->Enable(GL_BLEND);
	gl->DrawArrays(GL_TRIANGLES, 0, 6);
	gl->Disable(GL_BLEND);
	gl->Disable(GL_SCISSOR_TEST);
	if (gl_of(engine)->shown.holds)
		tiles_mark(&gl_of(engine)->shown.changed,
				   (struct box){(float)bounds->left, (float)bounds->top, (float)bounds->right, (float)bounds->bottom});
	engine->job.picture = PICTURE_SHOWN;
	return 0;
}

const struct pass gl_pass_ui = {.prepare = prepare, .run = run};
