/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "stage.h"

#include "scene-shaders.h"

bool stage_create_programs(struct scene *scene, char *error, size_t error_size)
{
	static const char *const sources[STAGE_PROGRAMS][2] = {
		[STAGE_SOLID] = {scene_shader_surface_vert, scene_shader_solid_frag},
		[STAGE_CUTOUT] = {scene_shader_surface_vert, scene_shader_cutout_frag},
		[STAGE_COLONNADE] = {scene_shader_shadowed_vert, scene_shader_colonnade_frag},
		[STAGE_SKY] = {scene_shader_sky_vert, scene_shader_sky_frag},
		[STAGE_OVERLAY] = {scene_shader_overlay_vert, scene_shader_overlay_frag},
	};
	for (int i = 0; i < STAGE_PROGRAMS; i++) {
		scene->programs[i] = scene_gl_program(&scene->gl, sources[i][0], sources[i][1], error, error_size);
		if (!scene->programs[i])
			return false;
	}
	return true;
}
