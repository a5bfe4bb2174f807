/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "stage.h"

#include <string.h>

struct mat4 stage_projection(const struct scene *scene)
{
	const struct stage_look *look = &scene->look;
	return mat4_perspective(look->fov_y, (double)scene->width / (double)scene->height, look->near, look->far);
}

static GLint uniform(const struct scene *scene, enum stage_program program, const char *name)
{
	return scene->gl.GetUniformLocation(scene->programs[program], name);
}

static void set_vec3(const struct scene *scene, enum stage_program program, const char *name, struct vec3 v)
{
	scene->gl.Uniform3f(uniform(scene, program, name), (float)v.x, (float)v.y, (float)v.z);
}

static void set_mat4(const struct scene *scene, GLint location, const struct mat4 *matrix)
{
	float m[16];
	for (int i = 0; i < 16; i++)
		m[i] = (float)matrix->m[i];
	scene->gl.UniformMatrix4fv(location, 1, GL_FALSE, m);
}

static void set_mat3(const struct scene *scene, enum stage_program program, const char *name, const double *matrix)
{
	float m[9];
	for (int i = 0; i < 9; i++)
		m[i] = (float)matrix[i];
	scene->gl.UniformMatrix3fv(uniform(scene, program, name), 1, GL_FALSE, m);
}

/* What stays the same for all draws of one program in one frame. */
static void use_program(const struct scene *scene, enum stage_program program, double motion_sign)
{
	const struct scene_gl *gl = &scene->gl;
	const struct stage_look *look = &scene->look;
	gl->UseProgram(scene->programs[program]);
	gl->Uniform1i(uniform(scene, program, "u_material"), 0);
	gl->Uniform2f(uniform(scene, program, "u_motion_scale"), (float)(0.5 * scene->width * motion_sign),
				  (float)(-0.5 * scene->height * motion_sign));
	gl->Uniform4f(uniform(scene, program, "u_sway"), (float)scene->now.sway[0], (float)scene->now.sway[1],
				  (float)scene->other.sway[0], (float)scene->other.sway[1]);
	set_vec3(scene, program, "u_sun_direction", look->sun_direction);
	set_vec3(scene, program, "u_sun_color", look->sun_color);
	set_vec3(scene, program, "u_sky_color", look->sky_color);
	set_vec3(scene, program, "u_bounce_color", look->bounce_color);
	gl->Uniform4f(uniform(scene, program, "u_sway_size"), (float)look->sway_size.x, (float)look->sway_size.y,
				  (float)look->sway_size.z, 0.0f);
	gl->Uniform4f(uniform(scene, program, "u_haze"), (float)look->haze.x, (float)look->haze.y, (float)look->haze.z,
				  (float)(1.0 / (look->haze_distance * look->haze_distance)));
}

struct draw_uniforms {
	GLint now, other, model, tint, id_base;
};

static void draw_range(const struct scene *scene, const struct stage_draw *draw, const struct draw_uniforms *at,
					   const struct mat4 *now, const struct mat4 *other)
{
	const struct scene_gl *gl = &scene->gl;
	const struct stage_range *range = &scene->ranges[draw->range];
	struct mat4 to_now = mat4_multiply(*now, scene->now.parts[draw->part]);
	struct mat4 to_other = mat4_multiply(*other, scene->other.parts[draw->part]);
	set_mat4(scene, at->now, &to_now);
	set_mat4(scene, at->other, &to_other);
	set_mat4(scene, at->model, &scene->now.parts[draw->part]);
	if (draw->tinted)
		gl->Uniform4f(at->tint, draw->tint[0], draw->tint[1], draw->tint[2], draw->tint[3]);
	else
		gl->Uniform4f(at->tint, 1.0f, 1.0f, 1.0f, 0.0f);
	gl->Uniform1ui(at->id_base, draw->id_base);
	gl->DrawElements(GL_TRIANGLES, (GLsizei)range->count, GL_UNSIGNED_INT,
					 (const void *)(uintptr_t)(range->first * sizeof(uint32_t)));
}

/* Clip position now (x, y, 1) to a direction in the world, for a point infinitely far away. */
static void sky_ray(const struct stage_pose *pose, double x_scale, double y_scale, double *out)
{
	const double *v = pose->view.m;
	for (int row = 0; row < 3; row++) {
		out[row] = v[row * 4] / x_scale;
		out[3 + row] = v[row * 4 + 1] / y_scale;
		out[6 + row] = -v[row * 4 + 2];
	}
}

static void draw_sky(const struct scene *scene, double motion_sign)
{
	const struct scene_gl *gl = &scene->gl;
	const struct stage_look *look = &scene->look;
	struct mat4 projection = stage_projection(scene);
	double ray[9], move[9];
	sky_ray(&scene->now, projection.m[0], projection.m[5], ray);
	for (int c = 0; c < 3; c++) {
		struct vec3 d = mat4_direction(&scene->other.view, vec3(ray[c * 3], ray[c * 3 + 1], ray[c * 3 + 2]));
		move[c * 3] = d.x * projection.m[0];
		move[c * 3 + 1] = d.y * projection.m[5];
		move[c * 3 + 2] = -d.z;
	}
	/* A still camera leaves the sky exactly still, whatever the rounding. */
	if (memcmp(&scene->now.view, &scene->other.view, sizeof(scene->now.view)) == 0)
		memcpy(move, (const double[9]){1, 0, 0, 0, 1, 0, 0, 0, 1}, sizeof(move));
	use_program(scene, STAGE_SKY, motion_sign);
	set_mat3(scene, STAGE_SKY, "u_sky_other", move);
	set_mat3(scene, STAGE_SKY, "u_sky_ray", ray);
	set_vec3(scene, STAGE_SKY, "u_horizon", look->horizon);
	set_vec3(scene, STAGE_SKY, "u_zenith", look->zenith);
	set_vec3(scene, STAGE_SKY, "u_sun_glow", look->sun_glow);
	gl->Uniform4f(uniform(scene, STAGE_SKY, "u_clouds"), (float)look->clouds.x, (float)look->clouds.y,
				  (float)look->clouds.z, (float)look->cloud_layer);
	gl->DepthFunc(GL_LEQUAL);
	gl->DrawArrays(GL_TRIANGLES, 0, 3);
}

static void set_state(const struct scene *scene)
{
	const struct scene_gl *gl = &scene->gl;
	gl->Viewport(0, 0, (GLsizei)scene->width, (GLsizei)scene->height);
	gl->Disable(GL_SCISSOR_TEST);
	gl->Disable(GL_STENCIL_TEST);
	gl->Disable(GL_BLEND);
	gl->Disable(GL_POLYGON_OFFSET_FILL);
	gl->Disable(GL_RASTERIZER_DISCARD);
	gl->Disable(GL_DITHER);
	gl->Disable(GL_SAMPLE_ALPHA_TO_COVERAGE);
	if (!gl->es)
		gl->Disable(GL_FRAMEBUFFER_SRGB);
	gl->Enable(GL_DEPTH_TEST);
	gl->Enable(GL_CULL_FACE);
	gl->CullFace(GL_BACK);
	gl->FrontFace(GL_CCW);
	gl->DepthFunc(GL_LESS);
	gl->DepthMask(GL_TRUE);
	gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
	gl->ActiveTexture(GL_TEXTURE0);
	gl->BindSampler(0, 0);
}

void stage_draw_plan(const struct scene *scene, double motion_sign)
{
	const struct scene_gl *gl = &scene->gl;
	const float far = 1.0f;
	struct mat4 projection = stage_projection(scene);
	struct mat4 now = mat4_multiply(projection, scene->now.view);
	struct mat4 other = mat4_multiply(projection, scene->other.view);
	enum stage_program current = STAGE_PROGRAMS;
	struct draw_uniforms at = {0};
	set_state(scene);
	gl->ClearBufferfv(GL_DEPTH, 0, &far);
	gl->BindTexture(GL_TEXTURE_2D_ARRAY, scene->materials);
	gl->BindVertexArray(scene->vertex_array);
	for (uint32_t i = 0; i < scene->plan.draw_count; i++) {
		const struct stage_draw *draw = &scene->plan.draws[i];
		if (draw->program != current) {
			current = draw->program;
			use_program(scene, current, motion_sign);
			at = (struct draw_uniforms){uniform(scene, current, "u_now"), uniform(scene, current, "u_other"),
										uniform(scene, current, "u_model"), uniform(scene, current, "u_draw_tint"),
										uniform(scene, current, "u_id_base")};
		}
		draw_range(scene, draw, &at, &now, &other);
	}
	draw_sky(scene, motion_sign);
}

void stage_draw_overlay(struct scene *scene)
{
	const struct scene_gl *gl = &scene->gl;
	const float clear[4] = {0.0f, 0.0f, 0.0f, 0.0f};
	uint64_t hash = overlay_hash(&scene->overlay);
	if (scene->ui_drawn && hash == scene->ui_hash)
		return;
	set_state(scene);
	gl->Disable(GL_DEPTH_TEST);
	gl->Disable(GL_CULL_FACE);
	gl->Enable(GL_BLEND);
	gl->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
	gl->BindFramebuffer(GL_FRAMEBUFFER, scene->ui_frame);
	gl->ClearBufferfv(GL_COLOR, 0, clear);
	gl->BindVertexArray(scene->overlay_array);
	gl->BindBuffer(GL_ARRAY_BUFFER, scene->overlay_buffer);
	gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(scene->overlay.count * sizeof(*scene->overlay.vertices)),
				   scene->overlay.vertices, GL_STREAM_DRAW);
	gl->UseProgram(scene->programs[STAGE_OVERLAY]);
	gl->Uniform1i(uniform(scene, STAGE_OVERLAY, "u_glyphs"), 0);
	gl->Uniform2f(uniform(scene, STAGE_OVERLAY, "u_size"), (float)scene->width, (float)scene->height);
	gl->BindTexture(GL_TEXTURE_2D, scene->glyphs);
	gl->DrawArrays(GL_TRIANGLES, 0, (GLsizei)scene->overlay.count);
	scene->ui_drawn = true;
	scene->ui_hash = hash;
}
