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

/* Its marked tiles; there when it returns, or when job.arrival has come. */
static int read_tiles(struct engine *engine, const struct target *picture, uint64_t *bytes, struct error *error)
{
	const struct gl *gl = table_of(engine);
	struct readback *readback = &gl_of(engine)->readback;
	const struct engine_image *image = engine->job.image;
	const struct readback_image to = {image->data, image->stride, &gl_of(engine)->leaving, picture->framebuffer};
	struct arrival now = {.missing = 0};
	if (!engine->job.arrival) {
		const int result = readback_ask(readback, gl, &to, &now, false, bytes, error);
		return result < 0 ? result : readback_receive(readback, gl, &now, error);
	}
	if (readback->buffered)
		widen_stream(engine);
	const int result = readback_ask(readback, gl, &to, engine->job.arrival, true, bytes, error);
	gl->Flush();
	return result;
}

static int run(struct engine *engine, struct error *error)
{
	const struct target *picture;
	struct sheet sheet;
	uint64_t bytes = 0;
	int result = gl_picture(engine, engine->job.picture, &picture, error);
	if (result == 0)
		result = gl_open_image(engine, &sheet, error);
	if (result < 0)
		return result;
	result = read_tiles(engine, picture, &bytes, error);
	if (result < 0)
		return result;
	engine->report.bytes_down += bytes;
	gl_close_image(engine, &sheet, bytes);
	return 0;
}

const struct pass gl_pass_read = {.run = run};
