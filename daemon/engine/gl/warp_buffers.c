/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/warp_buffers.h"

#include <stddef.h>

#include "shaders/limits.h"

static void make(struct warp_buffers *buffers, const struct gl *gl)
{
	gl->GenVertexArrays(1, &buffers->array);
	gl->GenBuffers(1, &buffers->vertices);
	gl->GenBuffers(1, &buffers->indices);
	gl->BindVertexArray(buffers->array);
	gl->BindBuffer(GL_ARRAY_BUFFER, buffers->vertices);
	gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers->indices);
	GLsizei stride = sizeof(struct plan_vertex);
	gl->VertexAttribPointer(ATTRIBUTE_POSITION, 2, GL_FLOAT, GL_FALSE, stride,
							(const void *)offsetof(struct plan_vertex, x));
	gl->VertexAttribPointer(ATTRIBUTE_DISPLACEMENT, 2, GL_FLOAT, GL_FALSE, stride,
							(const void *)offsetof(struct plan_vertex, ux));
	gl->VertexAttribPointer(ATTRIBUTE_DEPTH, 1, GL_FLOAT, GL_FALSE, stride,
							(const void *)offsetof(struct plan_vertex, z));
	gl->EnableVertexAttribArray(ATTRIBUTE_POSITION);
	gl->EnableVertexAttribArray(ATTRIBUTE_DISPLACEMENT);
	gl->EnableVertexAttribArray(ATTRIBUTE_DEPTH);
}

static uint64_t send_vertices(struct warp_buffers *buffers, const struct gl *gl, const struct plan *plan)
{
	GLsizeiptr size = (GLsizeiptr)((size_t)plan->columns * plan->rows * sizeof(*plan->vertices));
	gl->BindBuffer(GL_ARRAY_BUFFER, buffers->vertices);
	gl->BufferData(GL_ARRAY_BUFFER, size, plan->vertices, GL_STREAM_DRAW);
	return (uint64_t)size;
}

static uint64_t send_lists(struct warp_buffers *buffers, const struct gl *gl, const struct warp_mesh *mesh)
{
	GLsizeiptr size = (GLsizeiptr)((size_t)mesh->list_count * sizeof(*mesh->lists));
	gl->BindVertexArray(buffers->array);
	gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, size, mesh->lists, GL_STREAM_DRAW);
	return (uint64_t)size;
}

uint64_t warp_buffers_update(struct warp_buffers *buffers, const struct gl *gl, const struct warp_mesh *mesh)
{
	uint64_t sent = 0;
	if (!buffers->array)
		make(buffers, gl);
	if (buffers->begun != mesh->begun)
		sent += send_vertices(buffers, gl, mesh->plan);
	if (buffers->sorted != mesh->sorted)
		sent += send_lists(buffers, gl, mesh);
	buffers->begun = mesh->begun;
	buffers->sorted = mesh->sorted;
	return sent;
}

void warp_buffers_finish(struct warp_buffers *buffers, const struct gl *gl)
{
	gl->DeleteVertexArrays(1, &buffers->array);
	gl->DeleteBuffers(1, &buffers->vertices);
	gl->DeleteBuffers(1, &buffers->indices);
	*buffers = (struct warp_buffers){0};
}

void warp_buffers_draw(const struct warp_buffers *buffers, const struct gl *gl, struct warp_list list)
{
	if (!list.count)
		return;
	gl->BindVertexArray(buffers->array);
	gl->DrawElements(GL_TRIANGLES, (GLsizei)list.count, GL_UNSIGNED_INT,
					 (const void *)((size_t)list.first * sizeof(uint32_t)));
}
