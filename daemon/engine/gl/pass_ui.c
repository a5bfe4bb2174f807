/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The UI layer over everything else, in code values, never warped or blurred. */
#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>

static const char *prepare(struct engine *engine)
{
	return bounds_empty(&engine->ui_bounds) ? "absent" : NULL;
}

static int copy_to_shown(struct engine *engine, enum picture_id id, struct error *error)
{
	int result = gl_shown_begin(engine, error);
	if (result < 0)
		return result;
	gl_shown_keep(engine, id);
	result = gl_shown_copy(engine, id, error);
	if (result == 0)
		gl_shown_end(engine);
	return result;
}

/* Over what was written: the rest has its UI. */
static int blend(struct engine *engine, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct bounds *bounds = &engine->ui_bounds;
	struct gl_shown *shown = &gl_of(engine)->shown;
	int result = tile_buffer_load(&shown->rectangles, gl, &shown->written, error);
	gl->Enable(GL_SCISSOR_TEST);
	gl->Scissor((GLint)bounds->left, (GLint)bounds->top, (GLsizei)(bounds->right - bounds->left),
				(GLsizei)(bounds->bottom - bounds->top));
	gl->Enable(GL_BLEND);
	if (result == 0)
		result = gl_copy_tiles(engine, picture_of(engine, PICTURE_UI), picture_of(engine, PICTURE_SHOWN),
							   &shown->rectangles, error);
	gl->Disable(GL_BLEND);
	gl->Disable(GL_SCISSOR_TEST);
	return result;
}

static int run(struct engine *engine, struct error *error)
{
	struct gl_shown *shown = &gl_of(engine)->shown;
	int result = 0;
	if (engine->job.picture != PICTURE_SHOWN)
		result = copy_to_shown(engine, engine->job.picture, error);
	if (result < 0)
		return result;
	const uint64_t number = shown->number;
	shown->number = 0;
	result = blend(engine, error);
	if (result == 0)
		shown->number = number;
	engine->job.picture = PICTURE_SHOWN;
	return result;
}

const struct pass gl_pass_ui = {.prepare = prepare, .run = run};
