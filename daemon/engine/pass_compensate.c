/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The original with more, the in-betweens with less of what the blur takes away (docs/method.md, 5 and 6). */
#include "daemon/engine/pass.h"

#include <errno.h>

#include "shaders/limits.h"

static const char *prepare(struct engine *engine)
{
	return NULL;
}

static int make_targets(struct engine *engine, struct error *error)
{
	const struct gl *gl = engine_gl(engine);
	uint32_t width = engine->color.width, height = engine->color.height;
	bool resized = engine->real.width != width || engine->real.height != height;
	int result = target_resize(&engine->real, gl, width, height, error);
	if (result == 0)
		result = target_resize(&engine->between, gl, width, height, error);
	if (result < 0 || (!resized && engine->both_framebuffer))
		return result;
	if (!engine->both_framebuffer)
		gl->GenFramebuffers(1, &engine->both_framebuffer);
	gl->BindFramebuffer(GL_FRAMEBUFFER, engine->both_framebuffer);
	gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, engine->real.texture, 0);
	gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D, engine->between.texture, 0);
	gl->DrawBuffers(2, (const GLenum[]){GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1});
	return 0;
}

static unsigned variant(const struct engine *engine)
{
	unsigned flags = engine->params.blur == ENGINE_BLUR_EVERYWHERE ? VARIANT_WEIGHT_ONE : 0;
	if (engine->params.no_compensation)
		return flags | VARIANT_NO_COMPENSATION;
	return flags | (engine->params.curve == ENGINE_CURVE_GAMMA ? VARIANT_GAMMA : 0);
}

static void bind(const struct engine *engine, const struct program *program)
{
	const struct gl *gl = engine_gl(engine);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_LOW);
	gl->BindTexture(GL_TEXTURE_2D, engine->low.texture);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	gl->BindTexture(GL_TEXTURE_2D, engine->color.texture);
	gl->Uniform2f(program->size, (float)engine->color.width, (float)engine->color.height);
	gl->Uniform1f(program->shift, 0.0f);
	gl->Uniform1f(program->last_phase, (float)engine->last_phase);
	gl->Uniform1f(program->count, (float)engine->n);
	gl->Uniform1f(program->boost, (float)engine->boost);
	gl->Uniform1f(program->gamma, engine->params.gamma);
}

static int run(struct engine *engine, struct error *error)
{
	const struct gl *gl = engine_gl(engine);
	int result = make_targets(engine, error);
	if (result < 0)
		return result;
	bool everywhere = engine->params.blur == ENGINE_BLUR_EVERYWHERE;
	if (!everywhere) {
		target_copy(&engine->color, &engine->real, gl);
		target_copy(&engine->color, &engine->between, gl);
	}
	const struct program *program = program_use(&engine->programs, gl, PROGRAM_COMPENSATE, variant(engine), error);
	if (!program)
		return -EIO;
	bind(engine, program);
	gl->BindFramebuffer(GL_FRAMEBUFFER, engine->both_framebuffer);
	gl->Viewport(0, 0, (GLsizei)engine->color.width, (GLsizei)engine->color.height);
	if (everywhere) {
		gl->BindVertexArray(engine->no_attributes);
		gl->DrawArrays(GL_TRIANGLES, 0, 6);
	} else {
		warp_mesh_draw(&engine->mesh, gl, engine->mesh.doubtful);
	}
	return 0;
}

const struct pass pass_compensate = {.name = "compensate", .prepare = prepare, .run = run};
