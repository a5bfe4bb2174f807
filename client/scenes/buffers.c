/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const void *offset(size_t bytes)
{
	return (const void *)bytes;
}

static void create_vertices(struct scene *scene, const struct mesh *mesh)
{
	const struct scene_gl *gl = &scene->gl;
	const GLsizei stride = sizeof(struct mesh_vertex);
	gl->GenVertexArrays(1, &scene->vertex_array);
	gl->GenBuffers(1, &scene->vertex_buffer);
	gl->GenBuffers(1, &scene->index_buffer);
	gl->BindVertexArray(scene->vertex_array);
	gl->BindBuffer(GL_ARRAY_BUFFER, scene->vertex_buffer);
	gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, scene->index_buffer);
	gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(mesh->vertex_count * sizeof(*mesh->vertices)), mesh->vertices,
				   GL_STATIC_DRAW);
	gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(mesh->index_count * sizeof(*mesh->indices)), mesh->indices,
				   GL_STATIC_DRAW);
	gl->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, offset(offsetof(struct mesh_vertex, position)));
	gl->VertexAttribPointer(1, 4, GL_BYTE, GL_TRUE, stride, offset(offsetof(struct mesh_vertex, normal)));
	gl->VertexAttribPointer(2, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(struct mesh_vertex, uv)));
	gl->VertexAttribPointer(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, offset(offsetof(struct mesh_vertex, tint)));
	gl->VertexAttribIPointer(4, 4, GL_UNSIGNED_BYTE, stride, offset(offsetof(struct mesh_vertex, extra)));
	gl->VertexAttribIPointer(5, 1, GL_UNSIGNED_INT, stride, offset(offsetof(struct mesh_vertex, id)));
	for (GLuint i = 0; i < 6; i++)
		gl->EnableVertexAttribArray(i);
}

/* Sampling between mipmap levels is a quarter of a frame's time where the processor does it. */
static GLint minifying_filter(const struct scene_gl *gl)
{
	const char *renderer = (const char *)gl->GetString(GL_RENDERER);
	bool software = renderer && (strstr(renderer, "llvmpipe") || strstr(renderer, "softpipe"));
	return software ? GL_LINEAR_MIPMAP_NEAREST : GL_LINEAR_MIPMAP_LINEAR;
}

static void fill_layer(struct scene *scene, uint32_t layer, uint8_t *pixels)
{
	uint32_t size = MATERIAL_SIZE;
	material_fill(scene->kind->materials[layer], pixels);
	double coverage = material_coverage(pixels, size);
	for (GLint level = 0; level < MATERIAL_LEVELS; level++) {
		scene->gl.TexSubImage3D(GL_TEXTURE_2D_ARRAY, level, 0, 0, (GLint)layer, (GLsizei)size, (GLsizei)size, 1,
								GL_RGBA, GL_UNSIGNED_BYTE, pixels);
		if (size > 1)
			material_halve(pixels, size, coverage);
		size /= 2;
	}
}

static bool create_materials(struct scene *scene)
{
	const struct scene_gl *gl = &scene->gl;
	uint8_t *pixels = malloc((size_t)MATERIAL_SIZE * MATERIAL_SIZE * 4);
	if (!pixels)
		return false;
	gl->GenTextures(1, &scene->materials);
	gl->BindTexture(GL_TEXTURE_2D_ARRAY, scene->materials);
	for (GLint level = 0; level < MATERIAL_LEVELS; level++) {
		GLsizei size = MATERIAL_SIZE >> level;
		gl->TexImage3D(GL_TEXTURE_2D_ARRAY, level, GL_RGBA8, size, size, (GLsizei)scene->kind->material_count, 0,
					   GL_RGBA, GL_UNSIGNED_BYTE, NULL);
	}
	gl->TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, minifying_filter(gl));
	gl->TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	gl->TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAX_LEVEL, MATERIAL_LEVELS - 1);
	for (uint32_t layer = 0; layer < scene->kind->material_count; layer++)
		fill_layer(scene, layer, pixels);
	free(pixels);
	return true;
}

static void create_overlay(struct scene *scene)
{
	const struct scene_gl *gl = &scene->gl;
	const GLsizei stride = sizeof(struct overlay_vertex);
	uint8_t pixels[OVERLAY_ATLAS_WIDTH * OVERLAY_ATLAS_HEIGHT];
	overlay_fill_atlas(pixels);
	gl->GenTextures(1, &scene->glyphs);
	gl->BindTexture(GL_TEXTURE_2D, scene->glyphs);
	gl->TexImage2D(GL_TEXTURE_2D, 0, GL_R8, OVERLAY_ATLAS_WIDTH, OVERLAY_ATLAS_HEIGHT, 0, GL_RED, GL_UNSIGNED_BYTE,
				   pixels);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	gl->GenVertexArrays(1, &scene->overlay_array);
	gl->GenBuffers(1, &scene->overlay_buffer);
	gl->BindVertexArray(scene->overlay_array);
	gl->BindBuffer(GL_ARRAY_BUFFER, scene->overlay_buffer);
	gl->VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(struct overlay_vertex, position)));
	gl->VertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(struct overlay_vertex, uv)));
	gl->VertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, offset(offsetof(struct overlay_vertex, color)));
	for (GLuint i = 0; i < 3; i++)
		gl->EnableVertexAttribArray(i);
}

bool stage_create_buffers(struct scene *scene, const struct mesh *mesh, char *error, size_t error_size)
{
	const struct scene_gl *gl = &scene->gl;
	gl->ActiveTexture(GL_TEXTURE0);
	gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
	gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
	gl->PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
	gl->PixelStorei(GL_UNPACK_SKIP_ROWS, 0);
	gl->PixelStorei(GL_UNPACK_SKIP_PIXELS, 0);
	create_vertices(scene, mesh);
	if (scene->kind->overlay)
		create_overlay(scene);
	if (!create_materials(scene)) {
		snprintf(error, error_size, "not enough memory for the materials of the scene %s", scene->kind->name);
		return false;
	}
	return true;
}

void stage_destroy_buffers(struct scene *scene)
{
	const struct scene_gl *gl = &scene->gl;
	gl->DeleteVertexArrays(1, &scene->vertex_array);
	gl->DeleteVertexArrays(1, &scene->overlay_array);
	gl->DeleteBuffers(1, &scene->vertex_buffer);
	gl->DeleteBuffers(1, &scene->index_buffer);
	gl->DeleteBuffers(1, &scene->overlay_buffer);
	gl->DeleteTextures(1, &scene->materials);
	gl->DeleteTextures(1, &scene->glyphs);
}
