/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The original with more, the in-betweens with less of what the blur takes away (docs/method.md, 5 and 6). */
#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>

#include "shaders/limits.h"

void gl_layers_forget(struct gl_layers *layers)
{
	layers->made = false;
	layers->shown = PICTURE_ORIGINAL;
}

void gl_layers_finish(struct gl_layers *layers, const struct gl *gl)
{
	target_finish(&layers->kept, gl);
	tile_buffer_finish(&layers->tiles, gl);
	warp_kept_finish(&layers->triangles, gl);
}

uint64_t gl_layers_bytes(const struct gl_layers *layers)
{
	return target_bytes(&layers->kept) + layers->tiles.vertices.bytes + layers->triangles.displacements.bytes +
		   layers->triangles.indices.bytes;
}

int gl_copy_tiles(struct engine *engine, const struct target *from, const struct target *to,
				  const struct tile_buffer *tiles, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct program *program = program_use(&gl_of(engine)->programs, gl, PROGRAM_COPY, 0, error);
	if (!program)
		return -EIO;
	target_draw_to(to, gl);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	gl->BindTexture(GL_TEXTURE_2D, from->texture);
	gl->Uniform2f(program->size, (float)to->width, (float)to->height);
	tile_buffer_draw(tiles, gl);
	return 0;
}

/* The tiles in which the three differ. */
static int copy_tiles(struct engine *engine, const struct target *from, const struct target *to, struct error *error)
{
	struct gl_layers *layers = &gl_of(engine)->layers;
	const struct gl *gl = table_of(engine);
	if (layers->variant & VARIANT_WEIGHT_ONE) {
		target_copy(from, to, gl);
		return 0;
	}
	return gl_copy_tiles(engine, from, to, &layers->tiles, error);
}

static void bind(const struct engine *engine, const struct program *program)
{
	const struct gl_layers *layers = &gl_of(engine)->layers;
	const struct gl *gl = table_of(engine);
	low_bind(engine, program, layers->level);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	gl->BindTexture(GL_TEXTURE_2D, layers->kept.texture);
	gl->Uniform2f(program->size, (float)layers->kept.width, (float)layers->kept.height);
	gl->Uniform1f(program->shift, 0.0f);
	gl->Uniform1f(program->last_phase, layers->last_phase);
	gl->Uniform1f(program->count, layers->count);
	gl->Uniform1f(program->boost, layers->boost);
	gl->Uniform1f(program->gamma, layers->gamma);
}

/* REAL or BETWEEN. */
static int draw(struct engine *engine, enum picture_id id, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	const unsigned variant = executor->layers.variant | (id == PICTURE_REAL ? VARIANT_REAL : 0);
	const struct program *program = program_use(&executor->programs, gl, PROGRAM_COMPENSATE, variant, error);
	if (!program)
		return -EIO;
	target_draw_to(&executor->pictures[PICTURE_ORIGINAL], gl);
	bind(engine, program);
	if (variant & VARIANT_WEIGHT_ONE) {
		gl->BindVertexArray(executor->no_attributes);
		gl->DrawArrays(GL_TRIANGLES, 0, 6);
	} else {
		warp_kept_draw(&executor->layers.triangles, gl);
	}
	return 0;
}

int gl_picture(struct engine *engine, enum picture_id id, const struct target **picture, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	struct gl_layers *layers = &executor->layers;
	const bool one_of_three = id == PICTURE_ORIGINAL || id == PICTURE_REAL || id == PICTURE_BETWEEN;
	*picture = &executor->pictures[one_of_three ? PICTURE_ORIGINAL : id];
	if (id == PICTURE_REAL && !layers->real_differs)
		id = PICTURE_ORIGINAL;
	if (!one_of_three || !layers->made || layers->shown == id)
		return 0;
	int result = gl_settle(engine, PICTURE_ORIGINAL, error);
	if (result == 0)
		result = id == PICTURE_ORIGINAL ? copy_tiles(engine, &layers->kept, *picture, error) : draw(engine, id, error);
	if (result == 0)
		layers->shown = id;
	return result;
}

static unsigned variant_of(const struct engine *engine)
{
	unsigned flags = engine->params.blur == ENGINE_BLUR_EVERYWHERE ? VARIANT_WEIGHT_ONE : 0;
	if (engine->params.no_compensation)
		return flags | VARIANT_NO_COMPENSATION;
	return flags | (engine->params.curve == ENGINE_CURVE_GAMMA ? VARIANT_GAMMA : 0);
}

static void take_settings(const struct engine *engine, struct gl_layers *layers)
{
	layers->variant = variant_of(engine);
	layers->real_differs = !engine->params.no_compensation;
	layers->level = engine->params.blur_level;
	layers->last_phase = (float)engine->last_phase;
	layers->count = (float)engine->n;
	layers->boost = (float)engine->boost;
	layers->gamma = engine->params.gamma;
}

static int load(struct engine *engine, struct gl_layers *layers, struct error *error)
{
	const struct gl *gl = table_of(engine);
	if (layers->variant & VARIANT_WEIGHT_ONE)
		return 0;
	int result = warp_kept_update(&layers->triangles, &gl_of(engine)->buffers, gl, &engine->mesh, engine->mesh.doubtful,
								  engine->bend.bent > 0, &engine->report.bytes_up, error);
	return result == 0 ? tile_buffer_load(&layers->tiles, gl, &engine->mesh.low, error) : result;
}

/* The real frame, since that is what is shown first; in-betweens when one is. */
static int run(struct engine *engine, struct error *error)
{
	struct gl_layers *layers = &gl_of(engine)->layers;
	const struct target *picture;
	int result = gl_picture(engine, PICTURE_ORIGINAL, &picture, error);
	gl_layers_forget(layers);
	take_settings(engine, layers);
	if (layers->variant & VARIANT_WEIGHT_ONE)
		tiles_mark_all(&engine->mesh.low);
	const uint64_t real = engine_new_number(engine);
	contents_layer(&gl_of(engine)->contents, &engine->mesh.low, real, engine_new_number(engine));
	if (result == 0)
		result = target_resize(&layers->kept, table_of(engine), engine->width, engine->height, error);
	if (result == 0)
		result = load(engine, layers, error);
	if (result == 0)
		result = copy_tiles(engine, picture, &layers->kept, error);
	layers->made = result == 0;
	return result == 0 ? gl_picture(engine, PICTURE_REAL, &picture, error) : result;
}

const struct pass gl_pass_compensate = {.run = run};
