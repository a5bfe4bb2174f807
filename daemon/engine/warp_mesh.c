/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/warp_mesh.h"

#include <errno.h>
#include <stddef.h>
#include <stdlib.h>

#include "shaders/limits.h"

/* A triangle's map from source to displaced coordinates. */
struct map {
	float norm;        /* squared Frobenius norm: the sum of both squared singular values */
	float determinant; /* their product, negative if it turns over */
};

static struct map triangle_map(const struct plan_vertex *vertices, const uint32_t *index, float phase)
{
	const struct plan_vertex *a = &vertices[index[0]], *b = &vertices[index[1]], *c = &vertices[index[2]];
	float bx = b->x - a->x, by = b->y - a->y, cx = c->x - a->x, cy = c->y - a->y;
	float bu = bx + phase * (b->ux - a->ux), bv = by + phase * (b->uy - a->uy);
	float cu = cx + phase * (c->ux - a->ux), cv = cy + phase * (c->uy - a->uy);
	float scale = 1.0f / (bx * cy - cx * by);
	float xx = (bu * cy - cu * by) * scale, xy = (cu * bx - bu * cx) * scale;
	float yx = (bv * cy - cv * by) * scale, yy = (cv * bx - bv * cx) * scale;
	return (struct map){ xx * xx + xy * xy + yx * yx + yy * yy, xx * yy - xy * yx };
}

/* Whether the larger singular value is above the limit; true for degenerate triangles. */
static bool stretches(struct map map, float limit)
{
	float squared = limit * limit;
	bool below = map.norm <= 2.0f * squared &&
	             squared * squared - squared * map.norm + map.determinant * map.determinant >= 0.0f;
	return !below;
}

bool warp_mesh_tears(const struct plan *plan, float phase)
{
	for (uint32_t i = 0; i < plan->index_count; i += 3)
		if (stretches(triangle_map(plan->vertices, plan->indices + i, phase), 1.0f + (float)TEAR_FROM))
			return true;
	return false;
}

static bool reserve(struct warp_mesh *mesh, uint32_t count)
{
	if (count <= mesh->capacity)
		return true;
	uint32_t *lists = realloc(mesh->lists, (size_t)count * sizeof(*lists));
	if (!lists)
		return false;
	mesh->lists = lists;
	mesh->capacity = count;
	return true;
}

static void put(uint32_t *list, uint32_t *count, const uint32_t *index)
{
	for (int i = 0; i < 3; i++)
		list[(*count)++] = index[i];
}

/* Three lists, each with room for all triangles. */
static void sort_triangles(struct warp_mesh *mesh, const struct plan *plan)
{
	uint32_t total = plan->index_count;
	uint32_t *whole = mesh->lists, *torn = mesh->lists + total, *doubtful = mesh->lists + 2 * (size_t)total;
	mesh->whole_count = mesh->torn_count = mesh->doubtful_count = 0;
	for (uint32_t i = 0; i < total; i += 3) {
		const uint32_t *index = plan->indices + i;
		struct map map = triangle_map(plan->vertices, index, plan->last_phase);
		if (stretches(map, 1.0f + (float)TEAR_FROM))
			put(torn, &mesh->torn_count, index);
		else
			put(whole, &mesh->whole_count, index);
		if (map.determinant > 0.0f && stretches(map, 1.0f + (float)BLUR_FROM))
			put(doubtful, &mesh->doubtful_count, index);
	}
	mesh->ordered_count = total;
}

static void upload_indices(struct warp_mesh *mesh, const struct gl *gl, const struct plan *plan, bool ordered)
{
	size_t total = plan->index_count;
	struct part {
		const uint32_t *list;
		uint32_t count, *first;
	} parts[] = {
		{ mesh->lists, ordered ? 0 : mesh->whole_count, &mesh->whole_first },
		{ mesh->lists + total, ordered ? 0 : mesh->torn_count, &mesh->torn_first },
		{ mesh->lists + 2 * total, mesh->doubtful_count, &mesh->doubtful_first },
		{ plan->indices, ordered ? mesh->ordered_count : 0, &mesh->ordered_first },
	};
	size_t sum = 0;
	for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++)
		sum += parts[i].count;
	gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(sum * sizeof(uint32_t)), NULL, GL_STREAM_DRAW);
	size_t first = 0;
	for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
		gl->BufferSubData(GL_ELEMENT_ARRAY_BUFFER, (GLintptr)(first * sizeof(uint32_t)),
		                  (GLsizeiptr)(parts[i].count * sizeof(uint32_t)), parts[i].list);
		*parts[i].first = (uint32_t)first;
		first += parts[i].count;
	}
	mesh->bytes = sum * sizeof(uint32_t);
}

static void make_buffers(struct warp_mesh *mesh, const struct gl *gl)
{
	gl->GenVertexArrays(1, &mesh->array);
	gl->GenBuffers(1, &mesh->vertices);
	gl->GenBuffers(1, &mesh->indices);
	gl->BindVertexArray(mesh->array);
	gl->BindBuffer(GL_ARRAY_BUFFER, mesh->vertices);
	gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh->indices);
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

int warp_mesh_upload(struct warp_mesh *mesh, const struct gl *gl, const struct plan *plan, bool ordered, struct error *error)
{
	if (!reserve(mesh, 3 * plan->index_count))
		return error_set(error, -ENOMEM, "out of memory for %u triangles", plan->index_count / 3);
	sort_triangles(mesh, plan);
	mesh->ordered = ordered;
	if (!mesh->array)
		make_buffers(mesh, gl);
	gl->BindVertexArray(mesh->array);
	gl->BindBuffer(GL_ARRAY_BUFFER, mesh->vertices);
	GLsizeiptr size = (GLsizeiptr)((size_t)plan->columns * plan->rows * sizeof(*plan->vertices));
	gl->BufferData(GL_ARRAY_BUFFER, size, plan->vertices, GL_STREAM_DRAW);
	upload_indices(mesh, gl, plan, ordered);
	mesh->bytes += (uint64_t)size;
	return 0;
}

void warp_mesh_finish(struct warp_mesh *mesh, const struct gl *gl)
{
	gl->DeleteVertexArrays(1, &mesh->array);
	gl->DeleteBuffers(1, &mesh->vertices);
	gl->DeleteBuffers(1, &mesh->indices);
	free(mesh->lists);
	*mesh = (struct warp_mesh){ 0 };
}

static void draw(const struct warp_mesh *mesh, const struct gl *gl, uint32_t first, uint32_t count)
{
	if (!count)
		return;
	gl->BindVertexArray(mesh->array);
	gl->DrawElements(GL_TRIANGLES, (GLsizei)count, GL_UNSIGNED_INT, (const void *)((size_t)first * sizeof(uint32_t)));
}

void warp_mesh_draw_whole(const struct warp_mesh *mesh, const struct gl *gl)
{
	draw(mesh, gl, mesh->whole_first, mesh->whole_count);
}

void warp_mesh_draw_torn(const struct warp_mesh *mesh, const struct gl *gl)
{
	draw(mesh, gl, mesh->torn_first, mesh->torn_count);
}

void warp_mesh_draw_ordered(const struct warp_mesh *mesh, const struct gl *gl)
{
	draw(mesh, gl, mesh->ordered_first, mesh->ordered_count);
}

void warp_mesh_draw_doubtful(const struct warp_mesh *mesh, const struct gl *gl)
{
	draw(mesh, gl, mesh->doubtful_first, mesh->doubtful_count);
}
