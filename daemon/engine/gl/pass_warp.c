/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The displaced grid, textured with the undisplaced picture (Didyk et al. 2010, Section 6, "Morphing"). */
#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>

#include "daemon/engine/warp_triangle.h"
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
	executor->depth_width = executor->depth_height = 0;
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

static void mark_list(const struct warp_mesh *mesh, struct warp_list list, bool still, float phase, struct tiles *tiles)
{
	const uint32_t *index = mesh->lists + list.first;
	for (const uint32_t *end = index + list.count; index < end; index += 3)
		if (still || !warp_triangle_rests(mesh, index))
			tiles_mark(tiles, triangle_box(mesh->plan->vertices, index, phase, 0.0f));
}

static bool any_rests(const struct warp_mesh *mesh)
{
	const uint32_t *index = mesh->lists + mesh->plain.first, *end = index + mesh->plain.count;
	while (index < end && !warp_triangle_rests(mesh, index))
		index += 3;
	return index < end;
}

/* The tiles that not only triangles touch that rest; false: those are all. */
static bool find_moving(const struct engine *engine, struct tiles *moving)
{
	const struct warp_mesh *mesh = &engine->mesh;
	const float phase = (float)engine->job.phase;
	if (any_rests(mesh)) {
		mark_list(mesh, mesh->plain, false, phase, moving);
		mark_list(mesh, mesh->torn, true, phase, moving);
		mark_list(mesh, mesh->folded, true, phase, moving);
		mark_list(mesh, mesh->folded_torn, true, phase, moving);
		tiles_sum(moving);
		return moving->count < moving->columns * moving->rows;
	}
	tiles_mark_all(moving);
	return false;
}

/* `moving`: NULL, or the tiles that have to be drawn; others that are drawn over with them are marked in `touched`. */
static int draw_mesh(struct engine *engine, const struct tiles *moving, struct tiles *touched, struct error *error)
{
	const struct gl *gl = table_of(engine);
	int result = warp_buffers_update(&gl_of(engine)->buffers, gl, &engine->mesh, moving, touched,
									 &engine->report.bytes_up, error);
	if (result == 0)
		result = bind_picture(engine, error);
	if (result < 0)
		return result;
	gl->Enable(GL_CULL_FACE);
	result = draw(engine, error);
	gl->Disable(GL_CULL_FACE);
	return result;
}

static int run(struct engine *engine, struct error *error)
{
	struct gl_shown *shown = &gl_of(engine)->shown;
	int result = gl_shown_begin(engine, error);
	if (result < 0)
		return result;
	const bool some_rest = find_moving(engine, &shown->moving);
	if (some_rest)
		gl_shown_keep(engine, engine->job.picture);
	if (engine->mesh.folds.count)
		result = make_depth(engine, error);
	if (result == 0)
		result = draw_mesh(engine, some_rest ? &shown->moving : NULL, &shown->copied, error);
	if (result == 0)
		result = gl_shown_copy(engine, engine->job.picture, error);
	if (result == 0)
		gl_shown_end(engine);
	return result;
}

const struct pass gl_pass_warp = {.run = run};
