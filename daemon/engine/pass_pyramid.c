/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pass.h"

#include <errno.h>

#include "shaders/limits.h"

static const char *prepare(struct engine *engine)
{
	return NULL;
}

static int run(struct engine *engine, struct error *error)
{
	const struct gl *gl = engine_gl(engine);
	if (!program_use(&engine->programs, gl, PROGRAM_PYRAMID, 0, error))
		return -EIO;
	const struct target *below = &engine->color;
	gl->BindVertexArray(engine->no_attributes);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	for (uint32_t i = 0; i < engine->params.blur_level; i++) {
		struct target *level = &engine->levels[i];
		int result = target_resize(level, gl, (below->width + 1) / 2, (below->height + 1) / 2, error);
		if (result < 0)
			return result;
		target_draw_to(level, gl);
		gl->BindTexture(GL_TEXTURE_2D, below->texture);
		gl->DrawArrays(GL_TRIANGLES, 0, 6);
		below = level;
	}
	return 0;
}

const struct pass pass_pyramid = { .name = "pyramid", .prepare = prepare, .run = run };
