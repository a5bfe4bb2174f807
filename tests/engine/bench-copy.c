/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/engine/bench-copy.h"

#include <errno.h>
#include <stdlib.h>

#include "daemon/engine/gl/context.h"
#include "daemon/engine/now.h"

#define TEXTURES 4u
#define WARM_UP 4u
#define COPIES 31u

struct copies {
	const struct gl *gl;
	GLuint textures[TEXTURES], framebuffers[TEXTURES], query;
	uint32_t side;
	bool queries;
};

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static void copies_init(struct copies *copies)
{
	const struct gl *gl = copies->gl;
	const GLsizei side = (GLsizei)copies->side;
	static const float grey[4] = {0.5f, 0.25f, 0.75f, 1.0f};
	gl->GenTextures(TEXTURES, copies->textures);
	gl->GenFramebuffers(TEXTURES, copies->framebuffers);
	for (uint32_t i = 0; i < TEXTURES; i++) {
		gl->BindTexture(GL_TEXTURE_2D, copies->textures[i]);
		gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, side, side, 0, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
		gl->BindFramebuffer(GL_FRAMEBUFFER, copies->framebuffers[i]);
		gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, copies->textures[i], 0);
		gl->ClearBufferfv(GL_COLOR, 0, grey);
	}
	if (copies->queries)
		gl->GenQueries(1, &copies->query);
	gl->Finish();
}

static void copies_finish(struct copies *copies)
{
	if (copies->queries)
		copies->gl->DeleteQueries(1, &copies->query);
	copies->gl->DeleteFramebuffers(TEXTURES, copies->framebuffers);
	copies->gl->DeleteTextures(TEXTURES, copies->textures);
}

static double copy_ns(const struct copies *copies, uint32_t index)
{
	const struct gl *gl = copies->gl;
	const GLint side = (GLint)copies->side;
	GLuint64 ns = 0;
	const uint64_t began = now_ns();
	gl->BindFramebuffer(GL_READ_FRAMEBUFFER, copies->framebuffers[index % TEXTURES]);
	gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, copies->framebuffers[(index + 1) % TEXTURES]);
	if (copies->queries)
		gl->BeginQuery(GL_TIME_ELAPSED, copies->query);
	gl->BlitFramebuffer(0, 0, side, side, 0, 0, side, side, GL_COLOR_BUFFER_BIT, GL_NEAREST);
	if (!copies->queries) {
		gl->Finish();
		return (double)(now_ns() - began);
	}
	gl->EndQuery(GL_TIME_ELAPSED);
	gl->GetQueryObjectui64v(copies->query, GL_QUERY_RESULT, &ns);
	return (double)ns;
}

double bench_copy_rate(const struct engine_params *params, uint32_t side, struct error *error)
{
	struct context *context = context_create(params, error);
	double times[COPIES];
	if (!context)
		return -1.0;
	struct copies copies = {.gl = &context->gl, .side = side};
	copies.queries = context->gl.timer_queries && !context->info.software;
	copies_init(&copies);
	for (uint32_t i = 0; i < WARM_UP + COPIES; i++) {
		const double ns = copy_ns(&copies, i);
		if (i >= WARM_UP)
			times[i - WARM_UP] = ns;
	}
	const GLenum code = context->gl.GetError();
	copies_finish(&copies);
	context_destroy(&context);
	if (code != GL_NO_ERROR)
		return error_set(error, -EIO, "GL error 0x%x while textures were copied", code);
	qsort(times, COPIES, sizeof(times[0]), compare);
	return times[COPIES / 2] > 0.0 ? 8.0 * side * side * 1e9 / times[COPIES / 2] : 0.0;
}
