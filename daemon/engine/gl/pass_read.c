/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pixels back to memory, rows top to bottom as they lie: nothing is flipped. */
#include "daemon/engine/gl/executor_gl.h"

/* The next real frame is not to wait on its way up for what is under way down. */
static void widen_stream(struct engine *engine)
{
	struct executor_gl *executor = gl_of(engine);
	stream_widen(&executor->stream, executor->contents.rows * (engine->ui_plane.role ? 2 : 1));
}

static int run(struct engine *engine, struct error *error)
{
	const struct gl *gl = table_of(engine);
	struct readback *readback = &gl_of(engine)->readback;
	const struct engine_image *image = engine->job.image;
	const struct target *picture;
	struct arrival now = {.missing = 0};
	int result = gl_picture(engine, engine->job.picture, &picture, error);
	if (result < 0)
		return result;
	gl->BindFramebuffer(GL_READ_FRAMEBUFFER, picture->framebuffer);
	const struct readback_image to = {image->data, image->stride, picture->width, picture->height};
	engine->report.bytes_down += 4 * (uint64_t)picture->width * picture->height;
	if (!engine->job.arrival) {
		result = readback_ask(readback, gl, &to, &now, false, error);
		return result < 0 ? result : readback_receive(readback, gl, &now, error);
	}
	if (readback->buffered)
		widen_stream(engine);
	result = readback_ask(readback, gl, &to, engine->job.arrival, true, error);
	gl->Flush();
	return result;
}

const struct pass gl_pass_read = {.run = run};
