/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The UI layer over everything else, in code values, never warped or blurred. */
#include "daemon/engine/pass.h"

#include <errno.h>

#include "shaders/limits.h"

static const char *prepare(struct engine *engine)
{
	return engine->ui_bounds.left < engine->ui_bounds.right ? NULL : "absent";
}

static int run(struct engine *engine, struct error *error)
{
	const struct gl *gl = engine_gl(engine);
	if (engine->job.picture != &engine->shown) {
		int result = target_resize(&engine->shown, gl, engine->color.width, engine->color.height, error);
		if (result < 0)
			return result;
		target_copy(engine->job.picture, &engine->shown, gl);
	}
	if (!program_use(&engine->programs, gl, PROGRAM_UI, 0, error))
		return -EIO;
	const struct bounds *bounds = &engine->ui_bounds;
	target_draw_to(&engine->shown, gl);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	gl->BindTexture(GL_TEXTURE_2D, engine->ui.texture);
	gl->BindVertexArray(engine->no_attributes);
	gl->Enable(GL_SCISSOR_TEST);
	gl->Scissor((GLint)bounds->left, (GLint)bounds->top, (GLsizei)(bounds->right - bounds->left),
				(GLsizei)(bounds->bottom - bounds->top));
	gl->Enable(GL_BLEND);
	gl->DrawArrays(GL_TRIANGLES, 0, 6);
	gl->Disable(GL_BLEND);
	gl->Disable(GL_SCISSOR_TEST);
	engine->job.picture = &engine->shown;
	return 0;
}

const struct pass pass_ui = {.name = "ui", .prepare = prepare, .run = run};
