/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The displaced grid, textured with the undisplaced picture (Didyk et al. 2010, Section 6, "Morphing"). */
#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>

#include "shaders/limits.h"

/* SHOWN may be another texture than last time even if the size is the same: it is attached anew. */
static int make_depth(struct engine *engine, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	const struct target *shown = picture_of(engine, PICTURE_SHOWN);
	if (!executor->depth) {
		gl->GenRenderbuffers(1, &executor->depth);
		gl->GenFramebuffers(1, &executor->depth_framebuffer);
	}
	gl->BindFramebuffer(GL_FRAMEBUFFER, executor->depth_framebuffer);
	gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, shown->texture, 0);
	if (executor->depth_width == shown->width && executor->depth_height == shown->height)
		return 0;
	gl->BindRenderbuffer(GL_RENDERBUFFER, executor->depth);
	gl->RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, (GLsizei)shown->width, (GLsizei)shown->height);
	gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, executor->depth);
	if (gl->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
		return error_set(error, -ENOMEM, "the renderer has no room for a depth buffer of %u x %u", shown->width,
						 shown->height);
	executor->depth_width = shown->width;
	executor->depth_height = shown->height;
	return 0;
}

static bool use(struct engine *engine, unsigned variant, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct program *program = program_use(&gl_of(engine)->programs, gl, PROGRAM_WARP, variant, error);
	if (!program)
		return false;
	gl->Uniform2f(program->size, (float)engine->width, (float)engine->height);
	gl->Uniform1f(program->shift, (float)engine->job.phase);
	gl->Uniform1f(program->last_phase, 0.0f);
	if (variant & VARIANT_TEAR)
		low_bind(engine, program, engine->params.blur_level);
	return true;
}

static int bind_picture(struct engine *engine, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const struct target *picture;
	const int result = gl_picture(engine, engine->job.picture, &picture, error);
	if (result < 0)
		return result;
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
	gl->BindTexture(GL_TEXTURE_2D, picture->texture);
	return 0;
}

static int draw_folded(struct engine *engine, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	const struct warp_mesh *mesh = &engine->mesh;
	const float far = 1.0f;
	if (!use(engine, mesh->keep_order && mesh->folded_torn.count ? VARIANT_TEAR : 0, error))
		return -EIO;
	gl->BindFramebuffer(GL_FRAMEBUFFER, executor->depth_framebuffer);
	gl->Enable(GL_DEPTH_TEST);
	gl->ClearBufferfv(GL_DEPTH, 0, &far);
	warp_buffers_draw(&executor->buffers, gl, mesh->folded);
	if (!mesh->keep_order && mesh->folded_torn.count) {
		if (!use(engine, VARIANT_TEAR, error))
			return -EIO;
		warp_buffers_draw(&executor->buffers, gl, mesh->folded_torn);
	}
	gl->Disable(GL_DEPTH_TEST);
	return 0;
}

/* Most triangles need nothing; few are torn; those that may lie over each other come last, with depth. */
static int draw(struct engine *engine, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	const struct warp_mesh *mesh = &engine->mesh;
	target_draw_to(picture_of(engine, PICTURE_SHOWN), gl);
	if (executor->buffers.plain.count && !use(engine, 0, error))
		return -EIO;
	warp_buffers_draw(&executor->buffers, gl, executor->buffers.plain);
	if (mesh->torn.count && !use(engine, VARIANT_TEAR, error))
		return -EIO;
	warp_buffers_draw(&executor->buffers, gl, mesh->torn);
	return mesh->folded.count || mesh->folded_torn.count ? draw_folded(engine, error) : 0;
}

/* Where SHOWN may not hold what does not move; NULL: it may not hold it anywhere. */
static const struct tiles *changed(const struct engine *engine)
{
	const struct shown *shown = &gl_of(engine)->shown;
	bool same = shown->holds && shown->begun == engine->mesh.begun && shown->picture == engine->job.picture;
	return same ? &shown->changed : NULL;
}

/* Without memory for the tiles all is drawn anew the next time. */
static void note_shown(struct engine *engine)
{
	struct shown *shown = &gl_of(engine)->shown;
	const struct warp_mesh *mesh = &engine->mesh;
	shown->picture = engine->job.picture;
	shown->begun = mesh->begun;
	shown->holds = tiles_copy(&shown->changed, &mesh->folds);
}

static int run(struct engine *engine, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	const struct tiles *kept = changed(engine);
	executor->shown.holds = false;
	int result = target_resize(picture_of(engine, PICTURE_SHOWN), gl, engine->width, engine->height, error);
	if (result == 0 && engine->mesh.folds.count)
		result = make_depth(engine, error);
	if (result == 0)
		result = warp_buffers_update(&executor->buffers, gl, &engine->mesh, kept, &engine->report.bytes_up, error);
	if (result == 0)
		result = bind_picture(engine, error);
	if (result < 0)
		return result;
	gl->Enable(GL_CULL_FACE);
	result = draw(engine, error);
	gl->Disable(GL_CULL_FACE);
	if (result == 0)
		note_shown(engine);
	return result;
}

const struct pass gl_pass_warp = {.run = run};
