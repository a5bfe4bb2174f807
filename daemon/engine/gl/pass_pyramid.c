/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>

#include "shaders/limits.h"

static void make_array(struct executor_gl *executor, const struct gl *gl)
{
	gl->GenVertexArrays(1, &executor->tile_array);
	gl->GenBuffers(1, &executor->tile_vertices.id);
	gl->BindVertexArray(executor->tile_array);
	gl->BindBuffer(GL_ARRAY_BUFFER, executor->tile_vertices.id);
	gl->VertexAttribPointer(ATTRIBUTE_POSITION, 2, GL_FLOAT, GL_FALSE, 0, NULL);
	gl->EnableVertexAttribArray(ATTRIBUTE_POSITION);
}

/* The marked tiles as triangles, bound for drawing; how many corners they have. */
static int load_tiles(struct engine *engine, const struct tiles *tiles, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	if (!executor->tile_array)
		make_array(executor, gl);
	float *to =
		dynamic_map(&executor->tile_vertices, gl, GL_ARRAY_BUFFER, tiles_most_numbers(tiles) * sizeof(*to), error);
	if (!to)
		return -ENOMEM;
	const size_t numbers = tiles_write(tiles, to);
	const int result = dynamic_unmap(gl, GL_ARRAY_BUFFER, error);
	gl->BindVertexArray(executor->tile_array);
	return result < 0 ? result : (int)(numbers / 2);
}

/* One picture from another by a program; the target's texels are 2^shift pixels of the original a side. */
static int make(struct engine *engine, const struct target *from, struct target *to, uint32_t shift, int corners,
				struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct program *program = program_use(&gl_of(engine)->programs, gl, PROGRAM_PYRAMID, 0, error);
	if (!program)
		return -EIO;
	target_draw_to(to, gl);
	gl->BindTexture(GL_TEXTURE_2D, from->texture);
	gl->Uniform2f(program->size, (float)(to->width << shift), (float)(to->height << shift));
	gl->DrawArrays(GL_TRIANGLES, 0, corners);
	return 0;
}

static int make_levels(struct engine *engine, struct error *error)
{
	const struct target *below = picture_of(engine, PICTURE_ORIGINAL);
	int corners = load_tiles(engine, &engine->mesh.levels, error), result = corners;
	for (uint32_t i = 0; i < engine->params.blur_level && i < MAX_LEVELS && result >= 0; i++) {
		struct target *level = &gl_of(engine)->levels[i];
		result = target_resize(level, table_of(engine), (below->width + 1) / 2, (below->height + 1) / 2, error);
		if (result == 0)
			result = make(engine, below, level, i + 1, corners, error);
		below = level;
	}
	return result;
}

static int run(struct engine *engine, struct error *error)
{
	if (engine->levels_everywhere)
		tiles_mark_all(&engine->mesh.levels);
	table_of(engine)->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	int result = make_levels(engine, error);
	engine->levels_made = engine->levels_everywhere ? LEVELS_ALL : LEVELS_MARKED;
	return result;
}

void low_bind(const struct engine *engine, const struct program *program)
{
	const struct gl *gl = table_of(engine);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_LOW);
	gl->BindTexture(GL_TEXTURE_2D, gl_of(engine)->levels[engine->params.blur_level - 1].texture);
	gl->Uniform1f(program->level_scale, 1.0f / (float)(1u << engine->params.blur_level));
}

const struct pass gl_pass_pyramid = {.run = run};
