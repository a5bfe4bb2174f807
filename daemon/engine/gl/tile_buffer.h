/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Marked tiles as rectangles in GL, to be drawn with shaders/tiles.vert. */
#ifndef PURSUIT_ENGINE_GL_TILE_BUFFER_H
#define PURSUIT_ENGINE_GL_TILE_BUFFER_H

#include "daemon/engine/gl/dynamic.h"
#include "daemon/engine/tiles.h"

/* A zeroed one is ready for use. */
struct tile_buffer {
	GLuint array;
	struct dynamic vertices;
	GLsizei corners;
};

/* Makes it hold the marked tiles. 0, or a negative errno with a sentence. */
int tile_buffer_load(struct tile_buffer *buffer, const struct gl *gl, const struct tiles *tiles, struct error *error);
/* With the program in use. */
void tile_buffer_draw(const struct tile_buffer *buffer, const struct gl *gl);
void tile_buffer_finish(struct tile_buffer *buffer, const struct gl *gl);

#endif
