/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>

#include <stdlib.h>

#include "shaders/limits.h"

static int reserve(struct engine *engine, size_t numbers, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	if (!executor->tile_array) {
		gl->GenVertexArrays(1, &executor->tile_array);
		gl->GenBuffers(1, &executor->tile_vertices);
		gl->BindVertexArray(executor->tile_array);
		gl->BindBuffer(GL_ARRAY_BUFFER, executor->tile_vertices);
		gl->VertexAttribPointer(ATTRIBUTE_POSITION, 2, GL_FLOAT, GL_FALSE, 0, NULL);
		gl->EnableVertexAttribArray(ATTRIBUTE_POSITION);
	}
	if (numbers <= executor->tile_capacity)
		return 0;
	free(executor->tile_numbers);
	executor->tile_numbers = malloc(numbers * sizeof(float));
	executor->tile_capacity = executor->tile_numbers ? numbers : 0;
	return executor->tile_numbers ? 0
								  : error_set(error, -ENOMEM, "out of memory for %zu corners of tiles", numbers / 2);
}

/* The marked tiles as triangles, bound for drawing; how many corners they have. */
static int load_tiles(struct engine *engine, const struct tiles *tiles, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	int result = reserve(engine, tiles_most_numbers(tiles), error);
	if (result < 0)
		return result;
	size_t numbers = tiles_write(tiles, executor->tile_numbers);
	gl->BindVertexArray(executor->tile_array);
	gl->BindBuffer(GL_ARRAY_BUFFER, executor->tile_vertices);
	gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(numbers * sizeof(float)), executor->tile_numbers, GL_STREAM_DRAW);
	return (int)(numbers / 2);
}

/* One picture from another by a program; the target's texels are 2^shift pixels of the original a side. */
static int make(struct engine *engine, enum program_kind kind, const struct target *from, struct target *to,
				uint32_t shift, int corners, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct program *program = program_use(&gl_of(engine)->programs, gl, kind, 0, error);
	if (!program)
		return -EIO;
	target_draw_to(to, gl);
	gl->BindTexture(GL_TEXTURE_2D, from->texture);
	gl->Uniform2f(program->size, (float)(to->width << shift), (float)(to->height << shift));
	gl->Uniform1f(program->level_scale, 1.0f / (float)(1u << engine->params.blur_level));
	gl->DrawArrays(GL_TRIANGLES, 0, corners);
	return 0;
}

static int make_levels(struct engine *engine, struct error *error)
{
	const struct target *below = picture_of(engine, PICTURE_ORIGINAL);
	int corners = load_tiles(engine, &engine->mesh.levels, error), result = corners;
	for (uint32_t i = 0; i < engine->params.blur_level && result >= 0; i++) {
		struct target *level = &gl_of(engine)->levels[i];
		result = target_resize(level, table_of(engine), (below->width + 1) / 2, (below->height + 1) / 2, error);
		if (result == 0)
			result = make(engine, PROGRAM_PYRAMID, below, level, i + 1, corners, error);
		below = level;
	}
	return result;
}

static int make_low(struct engine *engine, struct error *error)
{
	const struct target *top = &gl_of(engine)->levels[engine->params.blur_level - 1];
	int result = target_resize(picture_of(engine, PICTURE_LOW), table_of(engine), engine->width, engine->height, error);
	int corners = result == 0 ? load_tiles(engine, &engine->mesh.low, error) : result;
	return corners < 0 ? corners : make(engine, PROGRAM_LOW, top, picture_of(engine, PICTURE_LOW), 0, corners, error);
}

static int run(struct engine *engine, struct error *error)
{
	if (engine->levels_everywhere) {
		tiles_mark_all(&engine->mesh.levels);
		tiles_mark_all(&engine->mesh.low);
	}
	table_of(engine)->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	int result = make_levels(engine, error);
	if (result >= 0)
		result = make_low(engine, error);
	engine->levels_made = engine->levels_everywhere ? LEVELS_ALL : LEVELS_MARKED;
	return result;
}

const struct pass gl_pass_pyramid = {.run = run};
