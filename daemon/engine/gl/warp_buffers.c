/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/warp_buffers.h"

#include <errno.h>
#include <stddef.h>
#include <string.h>

#include "daemon/engine/warp_triangle.h"
#include "shaders/limits.h"

/* Vertex arrays remember the buffers that are bound to them, whatever memory these have. */
static void make_array(struct warp_buffers *buffers, const struct gl *gl)
{
	const GLsizei stride = sizeof(struct plan_vertex);
	gl->GenVertexArrays(1, &buffers->array);
	gl->GenBuffers(1, &buffers->vertices.id);
	gl->GenBuffers(1, &buffers->indices.id);
	gl->BindVertexArray(buffers->array);
	gl->BindBuffer(GL_ARRAY_BUFFER, buffers->vertices.id);
	gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers->indices.id);
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

static int send_vertices(struct warp_buffers *buffers, const struct gl *gl, const struct plan *plan, uint64_t *sent,
						 struct error *error)
{
	const size_t bytes = (size_t)plan->columns * plan->rows * sizeof(*plan->vertices);
	void *to = dynamic_map(&buffers->vertices, gl, GL_ARRAY_BUFFER, bytes, bytes, error);
	if (!to)
		return -ENOMEM;
	memcpy(to, plan->vertices, bytes);
	*sent += bytes;
	return dynamic_unmap(gl, GL_ARRAY_BUFFER, error);
}

/* The triangles of mesh->plain that have to be drawn; how many indices. */
static uint32_t put_moving(const struct warp_mesh *mesh, const struct tiles *moving, struct tiles *touched,
						   uint32_t *to)
{
	const uint32_t *from = mesh->lists + mesh->plain.first;
	uint32_t count = 0;
	for (uint32_t i = 0; i < mesh->plain.count; i += 3) {
		if (warp_triangle_rests(mesh, from + i)) {
			const struct box box = triangle_box(mesh->plan->vertices, from + i, 0.0f, 0.0f);
			if (!tiles_touch(moving, box))
				continue;
			tiles_mark(touched, box);
		}
		memcpy(to + count, from + i, 3 * sizeof(*to));
		count += 3;
	}
	return count;
}

static int send_lists(struct warp_buffers *buffers, const struct gl *gl, const struct warp_mesh *mesh,
					  const struct tiles *moving, struct tiles *touched, uint64_t *sent, struct error *error)
{
	const size_t bytes = (size_t)mesh->list_count * sizeof(*mesh->lists);
	gl->BindVertexArray(buffers->array);
	const size_t most = 2 * (size_t)mesh->plan->index_count * sizeof(*mesh->lists);
	uint32_t *to = bytes ? dynamic_map(&buffers->indices, gl, GL_ELEMENT_ARRAY_BUFFER, bytes, most, error) : NULL;
	buffers->plain = mesh->plain;
	buffers->split = moving != NULL;
	if (!to)
		return bytes ? -ENOMEM : 0;
	if (moving) {
		const uint32_t first = mesh->plain.first, end = first + mesh->plain.count;
		memcpy(to, mesh->lists, first * sizeof(*to));
		buffers->plain.count = put_moving(mesh, moving, touched, to + first);
		memcpy(to + end, mesh->lists + end, (mesh->list_count - end) * sizeof(*to));
	} else {
		memcpy(to, mesh->lists, bytes);
	}
	*sent += bytes;
	return dynamic_unmap(gl, GL_ELEMENT_ARRAY_BUFFER, error);
}

int warp_buffers_update(struct warp_buffers *buffers, const struct gl *gl, const struct warp_mesh *mesh,
						const struct tiles *moving, struct tiles *touched, uint64_t *sent, struct error *error)
{
	int result = 0;
	if (!buffers->array)
		make_array(buffers, gl);
	if (buffers->begun != mesh->begun)
		result = send_vertices(buffers, gl, mesh->plan, sent, error);
	if (result == 0 && (buffers->sorted != mesh->sorted || buffers->split || moving))
		result = send_lists(buffers, gl, mesh, moving, touched, sent, error);
	buffers->begun = result == 0 ? mesh->begun : 0;
	buffers->sorted = result == 0 ? mesh->sorted : 0;
	return result;
}

void warp_buffers_finish(struct warp_buffers *buffers, const struct gl *gl)
{
	gl->DeleteVertexArrays(1, &buffers->array);
	dynamic_finish(&buffers->vertices, gl);
	dynamic_finish(&buffers->indices, gl);
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
