/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The original with more, the in-betweens with less of what the blur takes away (docs/method.md, 5 and 6). */
#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>

#include "shaders/limits.h"

static int make_targets(struct engine *engine, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	uint32_t width = engine->width, height = engine->height;
	struct target *real = picture_of(engine, PICTURE_REAL), *between = picture_of(engine, PICTURE_BETWEEN);
	/* Each by itself: one of them may have failed the last time. */
	const bool resized =
		real->width != width || real->height != height || between->width != width || between->height != height;
	int result = target_resize(real, gl, width, height, error);
	if (result == 0)
		result = target_resize(between, gl, width, height, error);
	if (result < 0 || (!resized && executor->both_framebuffer))
		return result;
	if (!executor->both_framebuffer)
		gl->GenFramebuffers(1, &executor->both_framebuffer);
	gl->BindFramebuffer(GL_FRAMEBUFFER, executor->both_framebuffer);
	gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, real->texture, 0);
	gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D, between->texture, 0);
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
	const struct gl *gl = table_of(engine);
	low_bind(engine, program);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	gl->BindTexture(GL_TEXTURE_2D, picture_of(engine, PICTURE_ORIGINAL)->texture);
	gl->Uniform2f(program->size, (float)engine->width, (float)engine->height);
	gl->Uniform1f(program->shift, 0.0f);
	gl->Uniform1f(program->last_phase, (float)engine->last_phase);
	gl->Uniform1f(program->count, (float)engine->n);
	gl->Uniform1f(program->boost, (float)engine->boost);
	gl->Uniform1f(program->gamma, engine->params.gamma);
}

static int run(struct engine *engine, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	int result = make_targets(engine, error);
	if (result < 0)
		return result;
	bool everywhere = engine->params.blur == ENGINE_BLUR_EVERYWHERE;
	if (!everywhere) {
		result = warp_buffers_update(&executor->buffers, gl, &engine->mesh, NULL, &engine->report.bytes_up, error);
		if (result < 0)
			return result;
		target_copy(picture_of(engine, PICTURE_ORIGINAL), picture_of(engine, PICTURE_REAL), gl);
		target_copy(picture_of(engine, PICTURE_ORIGINAL), picture_of(engine, PICTURE_BETWEEN), gl);
	}
	const struct program *program = program_use(&executor->programs, gl, PROGRAM_COMPENSATE, variant(engine), error);
	if (!program)
		return -EIO;
	bind(engine, program);
	gl->BindFramebuffer(GL_FRAMEBUFFER, executor->both_framebuffer);
	gl->Viewport(0, 0, (GLsizei)engine->width, (GLsizei)engine->height);
	if (everywhere) {
		gl->BindVertexArray(executor->no_attributes);
		gl->DrawArrays(GL_TRIANGLES, 0, 6);
	} else {
		warp_buffers_draw(&executor->buffers, gl, engine->mesh.doubtful);
	}
	return 0;
}

const struct pass gl_pass_compensate = {.run = run};
