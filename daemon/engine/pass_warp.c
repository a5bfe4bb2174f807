/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The displaced grid, textured with the undisplaced picture (Didyk et al. 2010, Section 6, "Morphing"). */
#include "daemon/engine/pass.h"

#include <errno.h>

#include "shaders/limits.h"

static const char *prepare(struct engine *engine)
{
	return NULL;
}

static int make_depth(struct engine *engine, struct error *error)
{
	const struct gl *gl = engine_gl(engine);
	uint32_t width = engine->shown.width, height = engine->shown.height;
	if (engine->depth && engine->depth_width == width && engine->depth_height == height)
		return 0;
	if (!engine->depth) {
		gl->GenRenderbuffers(1, &engine->depth);
		gl->GenFramebuffers(1, &engine->depth_framebuffer);
	}
	gl->BindRenderbuffer(GL_RENDERBUFFER, engine->depth);
	gl->RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, (GLsizei)width, (GLsizei)height);
	gl->BindFramebuffer(GL_FRAMEBUFFER, engine->depth_framebuffer);
	gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, engine->shown.texture, 0);
	gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, engine->depth);
	if (gl->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
		return error_set(error, -ENOMEM, "the renderer has no room for a depth buffer of %u x %u", width, height);
	engine->depth_width = width;
	engine->depth_height = height;
	return 0;
}

/* Draws go to `shown`, with depth if triangles may lie over each other. */
static int open_target(struct engine *engine, bool depth, struct error *error)
{
	const struct gl *gl = engine_gl(engine);
	int result = target_resize(&engine->shown, gl, engine->color.width, engine->color.height, error);
	if (result < 0)
		return result;
	if (depth && (result = make_depth(engine, error)) < 0)
		return result;
	target_draw_to(&engine->shown, gl);
	gl->Enable(GL_CULL_FACE);
	if (!depth)
		return 0;
	gl->BindFramebuffer(GL_FRAMEBUFFER, engine->depth_framebuffer);
	gl->Enable(GL_DEPTH_TEST);
	const float far = 1.0f;
	gl->ClearBufferfv(GL_DEPTH, 0, &far);
	return 0;
}

static bool use(struct engine *engine, unsigned variant, struct error *error)
{
	const struct gl *gl = engine_gl(engine);
	const struct program *program = program_use(&engine->programs, gl, PROGRAM_WARP, variant, error);
	if (!program)
		return false;
	gl->Uniform2f(program->size, (float)engine->color.width, (float)engine->color.height);
	gl->Uniform1f(program->shift, (float)engine->job.phase);
	gl->Uniform1f(program->last_phase, 0.0f);
	gl->Uniform1f(program->level_scale, 1.0f / (float)(1u << engine->params.blur_level));
	return true;
}

/* Torn triangles are few and cost more, so they have a list and a program of their own, unless order matters. */
static int draw(struct engine *engine, struct error *error)
{
	const struct gl *gl = engine_gl(engine);
	bool ordered = engine->mesh.ordered;
	if (!use(engine, ordered && engine->tears ? VARIANT_TEAR : 0, error))
		return -EIO;
	if (ordered) {
		warp_mesh_draw_ordered(&engine->mesh, gl);
		return 0;
	}
	warp_mesh_draw_whole(&engine->mesh, gl);
	if (engine->tears && !use(engine, VARIANT_TEAR, error))
		return -EIO;
	warp_mesh_draw_torn(&engine->mesh, gl);
	return 0;
}

static int run(struct engine *engine, struct error *error)
{
	const struct gl *gl = engine_gl(engine);
	int result = open_target(engine, engine->plan.folded > 0 || engine->job.phase > engine->last_phase ||
	                         engine->job.phase < 0.0, error);
	if (result < 0)
		return result;
	if (engine->tears) {
		gl->ActiveTexture(GL_TEXTURE0 + UNIT_LEVEL);
		gl->BindTexture(GL_TEXTURE_2D, engine->levels[engine->params.blur_level - 1].texture);
	}
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	gl->BindTexture(GL_TEXTURE_2D, engine->job.picture->texture);
	result = draw(engine, error);
	gl->Disable(GL_CULL_FACE);
	gl->Disable(GL_DEPTH_TEST);
	return result;
}

const struct pass pass_warp = { .name = "warp", .prepare = prepare, .run = run };
