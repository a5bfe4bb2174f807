/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/tile_buffer.h"

#include <errno.h>

#include "shaders/limits.h"

static void make_array(struct tile_buffer *buffer, const struct gl *gl)
{
	gl->GenVertexArrays(1, &buffer->array);
	gl->GenBuffers(1, &buffer->vertices.id);
	gl->BindVertexArray(buffer->array);
	gl->BindBuffer(GL_ARRAY_BUFFER, buffer->vertices.id);
	gl->VertexAttribPointer(ATTRIBUTE_POSITION, 2, GL_UNSIGNED_SHORT, GL_FALSE, 0, NULL);
	gl->EnableVertexAttribArray(ATTRIBUTE_POSITION);
}

int tile_buffer_load(struct tile_buffer *buffer, const struct gl *gl, const struct tiles *tiles, struct error *error)
{
	if (!buffer->array)
		make_array(buffer, gl);
	buffer->corners = 0;
	const size_t most = tiles_most_numbers(tiles) * sizeof(uint16_t);
	uint16_t *to = dynamic_map(&buffer->vertices, gl, GL_ARRAY_BUFFER, most, most, error);
	if (!to)
		return -ENOMEM;
	const size_t numbers = tiles_write(tiles, to);
	const int result = dynamic_unmap(gl, GL_ARRAY_BUFFER, error);
	if (result == 0)
		buffer->corners = (GLsizei)(numbers / 2);
	return result;
}

void tile_buffer_draw(const struct tile_buffer *buffer, const struct gl *gl)
{
	gl->BindVertexArray(buffer->array);
	gl->DrawArrays(GL_TRIANGLES, 0, buffer->corners);
}

void tile_buffer_finish(struct tile_buffer *buffer, const struct gl *gl)
{
	gl->DeleteVertexArrays(1, &buffer->array);
	dynamic_finish(&buffer->vertices, gl);
	*buffer = (struct tile_buffer){0};
}
