/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The engine's GLSL as text, embedded while building. Without #version, precision and limits.h. */
#ifndef PURSUIT_SHADERS_SHADERS_H
#define PURSUIT_SHADERS_SHADERS_H

extern const char shader_limits[];
extern const char shader_rectangle_vert[];
extern const char shader_grid_vert[];
extern const char shader_tiles_vert[];
extern const char shader_pyramid_frag[];
extern const char shader_compensate_frag[];
extern const char shader_warp_frag[];
extern const char shader_copy_frag[];
extern const char shader_analyse_comp[];

#endif
