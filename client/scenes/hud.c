/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A flight along an avenue under a dense user interface; hud_layout.c draws the interface. */
#include "hud_layout.h"
#include "stage.h"

enum { LAYER_FACADE, LAYER_ASPHALT, LAYER_BRICK, LAYER_PAVING, LAYER_PAINT, LAYER_CLOUDS };
enum { VARIANTS = 5, RANGE_BLOCK, RANGE_STREET = RANGE_BLOCK + VARIANTS, RANGE_CRAFT };
enum { PART_CRAFT, PART_CELLS = PART_CRAFT + 3, CELLS = 11 };

static const double cell = 24.0;

static void build_tower(struct mesh *mesh, double x, double z, uint32_t seed)
{
	static const uint32_t tints[6] = {0xf0d8b8, 0xd8b8a0, 0xc0d0e0, 0xe8e0d8, 0xb8a8c8, 0xe0c898};
	double width = 4.0 + 2.0 * scene_random(seed, 1), depth = 4.2 + 1.2 * scene_random(seed, 2);
	double height = 12.0 + 26.0 * scene_random(seed, 3) * (0.5 + 0.5 * scene_random(seed, 4));
	mesh_material(mesh, scene_random(seed, 5) > 0.25 ? LAYER_FACADE : LAYER_BRICK, 10.0);
	mesh_tint(mesh, tints[scene_hash(seed) % 6]);
	mesh_box(mesh, vec3(x - width, 0, z - depth), vec3(x + width, height, z + depth),
			 MESH_LEFT | MESH_RIGHT | MESH_FRONT | MESH_TOP);
	mesh_material(mesh, LAYER_PAVING, 4.0);
	mesh_tint(mesh, 0xb0a8a0);
	mesh_box(mesh, vec3(x - width - 0.3, height - 1.0, z - depth - 0.3),
			 vec3(x + width + 0.3, height + 0.4, z + depth + 0.3),
			 MESH_LEFT | MESH_RIGHT | MESH_FRONT | MESH_TOP | MESH_BOTTOM);
	if (scene_random(seed, 6) > 0.5)
		mesh_box(mesh, vec3(x - width * 0.5, height, z - depth * 0.5),
				 vec3(x + width * 0.5, height + 4.0, z + depth * 0.5), MESH_LEFT | MESH_RIGHT | MESH_FRONT | MESH_TOP);
}

static void build_sign(struct mesh *mesh, double side, double z, uint32_t seed)
{
	static const uint32_t tints[4] = {0xf04888, 0x38c8f0, 0xf0b030, 0x70e080};
	double y = 5.0 + 8.0 * scene_random(seed, 11);
	mesh_material(mesh, LAYER_PAINT, 3.0);
	mesh_tint(mesh, tints[scene_hash(seed) % 4]);
	mesh->brush.glow = 36;
	mesh_box(mesh, vec3(side * 7.6 - 0.9, y, z - 0.2), vec3(side * 7.6 + 0.9, y + 3.6, z + 0.2), MESH_ALL);
	mesh->brush.glow = 0;
}

static void build_craft(struct mesh *mesh)
{
	mesh_material(mesh, LAYER_PAINT, 1.0);
	mesh->brush.id = 8;
	mesh_ellipsoid(mesh, vec3(0, 0, 0), vec3(0.8, 0.42, 1.7), 14, 8);
	mesh_tint(mesh, 0x303848);
	mesh_ellipsoid(mesh, vec3(0, 0.28, -0.3), vec3(0.5, 0.32, 0.8), 12, 8);
	mesh_tint(mesh, 0xc8ccd8);
	for (int s = -1; s <= 1; s += 2)
		mesh_limb(mesh, vec3(0.95 * s, -0.1, -0.9), 0.26, vec3(0.95 * s, -0.1, 1.1), 0.30, 10);
	mesh_tint(mesh, 0x70e0ff);
	mesh->brush.glow = 100;
	for (int s = -1; s <= 1; s += 2)
		mesh_ellipsoid(mesh, vec3(0.95 * s, -0.1, 1.30), vec3(0.21, 0.21, 0.15), 10, 6);
	mesh->brush.glow = 0;
}

static void build(struct scene *scene, struct mesh *mesh)
{
	for (uint32_t variant = 0; variant < VARIANTS; variant++) {
		stage_begin(scene, mesh, RANGE_BLOCK + variant);
		for (uint32_t k = 0; k < 8; k++) {
			uint32_t seed = scene_hash(variant * 16 + k + 900);
			double side = k & 1 ? 1.0 : -1.0, far = k & 4 ? 29.0 : 14.5;
			mesh->brush.id = 10 + k;
			build_tower(mesh, side * far, -6.0 - ((k & 2) ? 12.0 : 0.0), seed);
			mesh->brush.id = 20 + k;
			if (k < 4 && scene_random(seed, 10) > 0.35)
				build_sign(mesh, side, -1.2 - ((k & 2) ? 12.0 : 0.0), seed);
		}
		stage_end(scene, mesh, RANGE_BLOCK + variant);
	}
	stage_begin(scene, mesh, RANGE_STREET);
	mesh->brush.id = 1;
	mesh_material(mesh, LAYER_ASPHALT, 6.0);
	mesh_tint(mesh, 0xc8c8d0);
	mesh_quad(mesh, vec3(-6, 0, 24), vec3(6, 0, 24), vec3(6, 0, -280), vec3(-6, 0, -280), vec3(0, 1, 0));
	mesh_material(mesh, LAYER_PAVING, 4.0);
	mesh_tint(mesh, 0xe0d4c8);
	for (int s = -1; s <= 1; s += 2)
		mesh_quad(mesh, vec3(6 * s, 0, 24), vec3(60 * s, 0, 24), vec3(60 * s, 0, -280), vec3(6 * s, 0, -280),
				  vec3(0, 1, 0));
	mesh->brush.id = 2;
	mesh_tint(mesh, 0xffe890);
	for (int k = -2; k < 20; k++)
		mesh_box(mesh, vec3(-0.2, -0.1, -6.0 * k - 3.0), vec3(0.2, 0.02, -6.0 * k), MESH_TOP);
	stage_end(scene, mesh, RANGE_STREET);
	stage_begin(scene, mesh, RANGE_CRAFT);
	build_craft(mesh);
	stage_end(scene, mesh, RANGE_CRAFT);
	scene->look = (struct stage_look){
		.sun_direction = vec3_normalize(vec3(-0.45, 0.42, 0.60)),
		.sun_color = vec3(1.15, 0.84, 0.56),
		.sky_color = vec3(0.38, 0.40, 0.56),
		.bounce_color = vec3(0.28, 0.22, 0.22),
		.horizon = vec3(0.96, 0.70, 0.46),
		.zenith = vec3(0.18, 0.28, 0.58),
		.sun_glow = vec3(0.5, 0.3, 0.15),
		.clouds = vec3(1.0, 0.80, 0.66),
		.cloud_layer = LAYER_CLOUDS,
		.haze = vec3(0.88, 0.66, 0.50),
		.haze_distance = 95.0,
		.fov_y = 1.0,
		.near = 0.3,
		.far = 320.0,
	};
}

static double flown(double time)
{
	return 14.0 * time;
}

static void plan(const struct scene *scene, double time, struct stage_plan *out)
{
	static const float colors[3][4] = {{0.93f, 0.34f, 0.24f, 0}, {0.95f, 0.84f, 0.36f, 0}, {0.34f, 0.68f, 0.90f, 0}};
	out->cell = floor(flown(time) / cell);
	for (uint32_t k = 0; k < 3; k++) {
		struct stage_draw *draw = stage_draw(out, STAGE_SOLID, RANGE_CRAFT, PART_CRAFT + k, 100 + k * 10);
		draw->tinted = true;
		for (int c = 0; c < 4; c++)
			draw->tint[c] = colors[k][c];
	}
	for (int k = 0; k < CELLS; k++) {
		uint32_t number = (uint32_t)(int64_t)fmod(out->cell + k, 65536.0) + 65536u;
		stage_draw(out, STAGE_SOLID, RANGE_BLOCK + scene_hash(number) % VARIANTS, (uint32_t)(PART_CELLS + k),
				   number * 64);
	}
	stage_draw(out, STAGE_SOLID, RANGE_STREET, STAGE_PARTS - 1, 0);
}

static void pose(const struct scene *scene, double time, const struct stage_plan *out, struct stage_pose *pose)
{
	double x = 2.2 * scene_wave(time, 9.0, 0.0), z = -(flown(time) - out->cell * cell);
	struct vec3 eye = vec3(x, 6.5 + 1.6 * scene_wave(time, 7.0, 0.1), z);
	double yaw = 0.16 * scene_wave(time, 9.0, 0.22), roll = 0.09 * scene_wave(time, 9.0, 0.25);
	struct mat4 level = mat4_look_at(eye, vec3_add(eye, vec3(sin(yaw), -0.05, -cos(yaw))));
	pose->view = mat4_multiply(mat4_rotation_z(roll), level);
	for (int k = 0; k < CELLS; k++)
		pose->parts[PART_CELLS + k] = mat4_translation(0, 0, -cell * (k - 0.3));
	for (int k = 0; k < 3; k++) {
		double ahead = 9.0 + 7.0 * k + 2.5 * scene_wave(time, 5.0 + k, 0.3 * k),
			   sway = scene_wave(time, 4.0 + 1.3 * k, 0.2 * k);
		struct mat4 at =
			mat4_translation(3.2 * sway + (k - 1) * 0.9, 5.2 + 1.1 * scene_wave(time, 3.1 + k, 0.5 * k), z - ahead);
		pose->parts[PART_CRAFT + k] =
			mat4_multiply(at, mat4_multiply(mat4_rotation_z(-0.5 * scene_wave(time, 4.0 + 1.3 * k, 0.2 * k + 0.25)),
											mat4_rotation_y(-0.25 * sway)));
	}
}

static void overlay(const struct scene *scene, double time, struct overlay *ui)
{
	hud_layout(ui, time);
}

const struct stage_kind scene_hud = {
	.name = "hud",
	.description = "a flight through a city under a dense user interface",
	.materials = {MATERIAL_FACADE, MATERIAL_ASPHALT, MATERIAL_BRICK, MATERIAL_PAVING, MATERIAL_PAINT, MATERIAL_CLOUDS},
	.material_count = 6,
	.build = build,
	.plan = plan,
	.pose = pose,
	.overlay = overlay,
};
