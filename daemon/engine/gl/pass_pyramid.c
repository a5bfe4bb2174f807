/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>

#include "shaders/limits.h"

/* One picture from another by a program; the target's texels are 2^shift pixels of the original a side. */
static int make(struct engine *engine, const struct target *from, struct target *to, uint32_t shift,
				struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct program *program = program_use(&gl_of(engine)->programs, gl, PROGRAM_PYRAMID, 0, error);
	if (!program)
		return -EIO;
	target_draw_to(to, gl);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	gl->BindTexture(GL_TEXTURE_2D, from->texture);
	gl->Uniform2f(program->size, (float)(to->width << shift), (float)(to->height << shift));
	tile_buffer_draw(&gl_of(engine)->level_tiles, gl);
	return 0;
}

static int make_levels(struct engine *engine, struct error *error)
{
	const struct target *below;
	int result = gl_picture(engine, PICTURE_ORIGINAL, &below, error);
	if (result == 0)
		result = tile_buffer_load(&gl_of(engine)->level_tiles, table_of(engine), &engine->mesh.levels, error);
	for (uint32_t i = 0; i < engine->params.blur_level && i < MAX_LEVELS && result == 0; i++) {
		struct target *level = &gl_of(engine)->levels[i];
		result = target_resize(level, table_of(engine), (below->width + 1) / 2, (below->height + 1) / 2, error);
		if (result == 0)
			result = make(engine, below, level, i + 1, error);
		below = level;
	}
	return result;
}

static int run(struct engine *engine, struct error *error)
{
	if (engine->levels_everywhere)
		tiles_mark_all(&engine->mesh.levels);
	int result = make_levels(engine, error);
	engine->levels_made = result < 0 ? LEVELS_NONE : engine->levels_everywhere ? LEVELS_ALL : LEVELS_MARKED;
	return result;
}

void low_bind(const struct engine *engine, const struct program *program, uint32_t level)
{
	const struct gl *gl = table_of(engine);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_LOW);
	gl->BindTexture(GL_TEXTURE_2D, gl_of(engine)->levels[level - 1].texture);
	gl->Uniform1f(program->level_scale, 1.0f / (float)(1u << level));
}

const struct pass gl_pass_pyramid = {.run = run};
