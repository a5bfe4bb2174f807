/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Textures whose pixels say where they are, and the comparison of a plane with them. */
#ifndef PURSUIT_GL_PATTERN_H
#define PURSUIT_GL_PATTERN_H

#include <GLES3/gl32.h>
#include <stdbool.h>
#include <stdint.h>

#include "proto/frame.h"

#define WIDTH 37
#define HEIGHT 23
#define GEOMETRY_WIDTH 19
#define GEOMETRY_HEIGHT 11

/* A new texture with the pattern in this internal format, in the current context. */
GLuint color_texture(GLenum internal);
GLuint depth_texture(GLenum internal);
GLuint motion_texture(GLenum internal);
GLuint id_texture(GLenum internal);

/* A pixel of a plane, in the memory of a slot. */
const void *pixel(const struct pursuit_plane *plane, const uint8_t *planes, uint32_t x, uint32_t y);

/* How many components differ. `turned`: rows upside down; `sign`: -1 where y points the other way. */
int wrong_colors(const struct pursuit_plane *plane, const uint8_t *planes, bool turned);
int wrong_motion(const struct pursuit_plane *plane, const uint8_t *planes, bool turned, float sign);
int wrong_ids(const struct pursuit_plane *plane, const uint8_t *planes);
double worst_depth(const struct pursuit_plane *plane, const uint8_t *planes);

#endif
