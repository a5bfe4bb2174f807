/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/gl/warp_buffers.h"

#include <errno.h>
#include <stddef.h>
#include <string.h>

#include "daemon/engine/warp_triangle.h"
#include "shaders/limits.h"

#define STRIDE ((GLsizei)sizeof(struct plan_vertex))

/* Displacements among the vertices. */
static void point_to_displacements(const struct gl *gl, GLuint vertices)
{
	gl->BindBuffer(GL_ARRAY_BUFFER, vertices);
	gl->VertexAttribPointer(ATTRIBUTE_DISPLACEMENT, 2, GL_FLOAT, GL_FALSE, STRIDE,
							(const void *)offsetof(struct plan_vertex, ux));
}

/* Vertex arrays remember the buffers that are bound to them, whatever memory these have. */
static void make_array(GLuint *array, const struct gl *gl, struct dynamic *vertices, struct dynamic *indices)
{
	gl->GenVertexArrays(1, array);
	if (!vertices->id)
		gl->GenBuffers(1, &vertices->id);
	gl->GenBuffers(1, &indices->id);
	gl->BindVertexArray(*array);
	gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices->id);
	point_to_displacements(gl, vertices->id);
	gl->VertexAttribPointer(ATTRIBUTE_POSITION, 2, GL_FLOAT, GL_FALSE, STRIDE,
							(const void *)offsetof(struct plan_vertex, x));
	gl->VertexAttribPointer(ATTRIBUTE_DEPTH, 1, GL_FLOAT, GL_FALSE, STRIDE,
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
	/* Those that are there to be counted only come last. */
	const uint32_t count = mesh->keep_order ? mesh->folded_torn.first : mesh->list_count;
	const size_t bytes = (size_t)count * sizeof(*mesh->lists);
	gl->BindVertexArray(buffers->array);
	const size_t most = (size_t)mesh->plan->index_count * sizeof(*mesh->lists);
	uint32_t *to = bytes ? dynamic_map(&buffers->indices, gl, GL_ELEMENT_ARRAY_BUFFER, bytes, most, error) : NULL;
	buffers->plain = mesh->plain;
	buffers->split = moving != NULL;
	if (!to)
		return bytes ? -ENOMEM : 0;
	if (moving) {
		const uint32_t first = mesh->plain.first, end = first + mesh->plain.count;
		memcpy(to, mesh->lists, first * sizeof(*to));
		buffers->plain.count = put_moving(mesh, moving, touched, to + first);
		memcpy(to + end, mesh->lists + end, (count - end) * sizeof(*to));
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
		make_array(&buffers->array, gl, &buffers->vertices, &buffers->indices);
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

/* ---- a list that is kept ---- */

static int send_displacements(struct warp_kept *kept, const struct gl *gl, const struct plan *plan, uint64_t *sent,
							  struct error *error)
{
	const uint32_t count = plan->columns * plan->rows;
	const size_t bytes = 2 * sizeof(float) * (size_t)count;
	float *to = dynamic_map(&kept->displacements, gl, GL_ARRAY_BUFFER, bytes, bytes, error);
	if (!to)
		return -ENOMEM;
	for (uint32_t i = 0; i < count; i++)
		memcpy(to + 2 * (size_t)i, &plan->vertices[i].ux, 2 * sizeof(*to));
	*sent += bytes;
	return dynamic_unmap(gl, GL_ARRAY_BUFFER, error);
}

static int send_kept(struct warp_kept *kept, const struct gl *gl, const struct warp_mesh *mesh, struct warp_list list,
					 uint64_t *sent, struct error *error)
{
	const size_t bytes = list.count * sizeof(*mesh->lists);
	const size_t most = (size_t)mesh->plan->index_count * sizeof(*mesh->lists);
	kept->count = 0;
	if (!bytes)
		return 0;
	void *to = dynamic_map(&kept->indices, gl, GL_ELEMENT_ARRAY_BUFFER, bytes, most, error);
	if (!to)
		return -ENOMEM;
	memcpy(to, mesh->lists + list.first, bytes);
	*sent += bytes;
	kept->count = (GLsizei)list.count;
	return dynamic_unmap(gl, GL_ELEMENT_ARRAY_BUFFER, error);
}

int warp_kept_update(struct warp_kept *kept, struct warp_buffers *buffers, const struct gl *gl,
					 const struct warp_mesh *mesh, struct warp_list list, bool bends, uint64_t *sent,
					 struct error *error)
{
	int result = 0;
	if (buffers->begun != mesh->begun)
		result = send_vertices(buffers, gl, mesh->plan, sent, error);
	buffers->begun = result == 0 ? mesh->begun : 0;
	if (!kept->array)
		make_array(&kept->array, gl, &buffers->vertices, &kept->indices);
	gl->BindVertexArray(kept->array);
	if (result == 0 && bends)
		result = send_displacements(kept, gl, mesh->plan, sent, error);
	if (bends)
		gl->VertexAttribPointer(ATTRIBUTE_DISPLACEMENT, 2, GL_FLOAT, GL_FALSE, 0, NULL);
	else
		point_to_displacements(gl, buffers->vertices.id);
	return result == 0 ? send_kept(kept, gl, mesh, list, sent, error) : result;
}

void warp_kept_draw(const struct warp_kept *kept, const struct gl *gl)
{
	if (!kept->count)
		return;
	gl->BindVertexArray(kept->array);
	gl->DrawElements(GL_TRIANGLES, kept->count, GL_UNSIGNED_INT, NULL);
}

void warp_kept_finish(struct warp_kept *kept, const struct gl *gl)
{
	gl->DeleteVertexArrays(1, &kept->array);
	dynamic_finish(&kept->displacements, gl);
	dynamic_finish(&kept->indices, gl);
	*kept = (struct warp_kept){0};
}
