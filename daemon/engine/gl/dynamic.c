/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/dynamic.h"

#include <errno.h>

void dynamic_reserve(struct dynamic *buffer, const struct gl *gl, GLenum target, size_t bytes, size_t most)
{
	if (!buffer->id)
		gl->GenBuffers(1, &buffer->id);
	gl->BindBuffer(target, buffer->id);
	if (bytes <= buffer->bytes)
		return;
	/* A little more: contents differ from frame to frame. */
	buffer->bytes = bytes + bytes / 4 < most ? bytes + bytes / 4 : most;
	gl->BufferData(target, (GLsizeiptr)buffer->bytes, NULL, GL_STREAM_DRAW);
}

void *dynamic_map(struct dynamic *buffer, const struct gl *gl, GLenum target, size_t bytes, size_t most,
				  struct error *error)
{
	dynamic_reserve(buffer, gl, target, bytes, most);
	void *data = gl->MapBufferRange(target, 0, (GLsizeiptr)bytes, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
	if (data)
		return data;
	buffer->bytes = 0;
	error_set(error, -ENOMEM, "the renderer has no room for a buffer of %zu bytes", bytes);
	return NULL;
}

int dynamic_unmap(const struct gl *gl, GLenum target, struct error *error)
{
	if (gl->UnmapBuffer(target))
		return 0;
	return error_set(error, -EIO, "the renderer lost a buffer on its way up");
}

void dynamic_finish(struct dynamic *buffer, const struct gl *gl)
{
	gl->DeleteBuffers(1, &buffer->id);
	*buffer = (struct dynamic){0};
}
