/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A table fan before a brick wall: the blades turn fast, the head swings slowly, the rest is still. */
#include "stage.h"

enum { LAYER_PLAIN, LAYER_BRICK, LAYER_WOOD, LAYER_FABRIC, LAYER_PAINT };
enum { RANGE_BLADE, RANGE_HUB, RANGE_HEAD, RANGE_ROOM };
enum { PART_ROOM, PART_HEAD, PART_HUB, PART_BLADE };
enum { BLADES = 4 };

static const double axis_height = 1.62;

/* One blade along +y, pitched, rounded, with a texture that shows how it turns. */
static void build_blade(struct mesh *mesh)
{
	enum { ALONG = 8, ACROSS = 4 };
	for (int side = -1; side <= 1; side += 2) {
		uint32_t v[ALONG + 1][ACROSS + 1];
		for (int j = 0; j <= ALONG; j++) {
			for (int i = 0; i <= ACROSS; i++) {
				double r = (double)j / ALONG, s = (double)i / ACROSS - 0.5;
				double width = 0.16 + 0.40 * sin(SCENE_PI * pow(r, 0.8) * 0.86 + 0.1);
				double x = s * width + 0.10 * r, y = 0.07 + 0.72 * (r - 0.09 * (4.0 * s * s) * r * r);
				struct vec3 p = vec3(x, y, -x * 0.42 + 0.04 * (1 - 4 * s * s) + side * 0.006);
				v[j][i] =
					mesh_add_vertex(mesh, p, vec3(0.38 * side + 0.3 * s * side, 0.05, side), s * width * 2.0, y * 2.0);
			}
		}
		for (int j = 0; j < ALONG; j++) {
			for (int i = 0; i < ACROSS; i++) {
				mesh_add_triangle(mesh, v[j][i], v[j][i + 1], v[j + 1][i + 1]);
				mesh_add_triangle(mesh, v[j][i], v[j + 1][i + 1], v[j + 1][i]);
			}
		}
	}
}

static void build_fan(struct scene *scene, struct mesh *mesh)
{
	static const double nose[][2] = {{0.135, -0.10}, {0.135, 0.03}, {0.115, 0.09}, {0.06, 0.125}, {0.0, 0.13}};
	static const double motor[][2] = {{0.0, -0.50}, {0.12, -0.48}, {0.19, -0.38}, {0.20, -0.20}, {0.15, -0.12}};
	stage_begin(scene, mesh, RANGE_BLADE);
	mesh_material(mesh, LAYER_FABRIC, 0.5);
	build_blade(mesh);
	stage_end(scene, mesh, RANGE_BLADE);
	stage_begin(scene, mesh, RANGE_HUB);
	mesh->transform = mat4_rotation_x(SCENE_PI / 2.0);
	mesh_material(mesh, LAYER_PAINT, 0.4);
	mesh_tint(mesh, 0xf2d060);
	mesh_lathe(mesh, vec3(0, 0, 0), nose, 5, 20, 3.0);
	stage_end(scene, mesh, RANGE_HUB);
	stage_begin(scene, mesh, RANGE_HEAD);
	mesh_tint(mesh, 0x70a898);
	mesh_lathe(mesh, vec3(0, 0, 0), motor, 5, 20, 3.0);
	mesh->transform = mat4_identity();
	mesh_material(mesh, LAYER_PLAIN, 1.0);
	mesh_tint(mesh, 0xe6e2d6);
	mesh->brush.id = 12;
	mesh_torus(mesh, 0.90, 0.028, 0, 2.0 * SCENE_PI, 48, 8);
	mesh->brush.id = 13;
	for (int k = 0; k < 6; k++) {
		double a = 2.0 * SCENE_PI * (k + 0.5) / 6.0;
		mesh_beam(mesh, vec3(0.1 * cos(a), 0.1 * sin(a), -0.30), vec3(0.9 * cos(a), 0.9 * sin(a), 0), 0.03, 0.03);
	}
	stage_end(scene, mesh, RANGE_HEAD);
}

static void build_books(struct mesh *mesh, double y, double from, double to, uint32_t seed)
{
	static const uint32_t tints[8] = {0xb84038, 0x386890, 0xd8a848, 0x487850, 0x784878, 0xd8d0b8, 0x404858, 0xc87840};
	double x = from;
	for (uint32_t i = 0; x < to; i++) {
		double width = 0.05 + 0.06 * scene_random(seed, i), height = 0.30 + 0.16 * scene_random(seed + 1, i);
		mesh->brush.id = seed + i;
		mesh_tint(mesh, tints[scene_hash2(seed, i) % 8]);
		mesh_box(mesh, vec3(x, y, -1.32), vec3(x + width - 0.006, y + height, -1.04),
				 MESH_FRONT | MESH_LEFT | MESH_RIGHT | MESH_TOP);
		x += width;
	}
}

static void build_shelf(struct mesh *mesh)
{
	for (uint32_t row = 0; row < 2; row++) {
		double y = 1.55 + 0.72 * row;
		mesh->brush.id = 40 + row;
		mesh_material(mesh, LAYER_WOOD, 1.0);
		mesh_tint(mesh, 0xc89868);
		mesh_box(mesh, vec3(1.15, y - 0.06, -1.38), vec3(2.75, y, -0.98), MESH_ALL);
		mesh_material(mesh, LAYER_FABRIC, 0.6);
		build_books(mesh, y, 1.2, row ? 2.2 : 2.65, 100 + row * 100);
	}
	static const double vase[][2] = {{0.10, 0.0}, {0.16, 0.10}, {0.15, 0.22}, {0.07, 0.34}, {0.09, 0.40}};
	mesh_material(mesh, LAYER_PLAIN, 0.5);
	mesh_tint(mesh, 0x4888a8);
	mesh->brush.id = 44;
	mesh_lathe(mesh, vec3(2.5, 2.27, -1.18), vase, 5, 14, 2.0);
}

static void build_picture(struct mesh *mesh)
{
	double z = -1.34, x = -2.55, y = 1.55, width = 1.35, height = 1.05;
	mesh_material(mesh, LAYER_WOOD, 0.5);
	mesh_tint(mesh, 0xa87848);
	mesh->brush.id = 50;
	mesh_box(mesh, vec3(x, y, z - 0.04), vec3(x + width, y + height, z + 0.03), MESH_ALL & ~MESH_BACK);
	mesh_material(mesh, LAYER_PLAIN, 1.0);
	static const uint32_t bands[5] = {0x4878a8, 0x88b0c8, 0xe8c890, 0xc87850, 0x486048};
	for (uint32_t i = 0; i < 5; i++) {
		double low = y + 0.08 + (height - 0.16) * (4 - i) / 5.0, high = y + 0.08 + (height - 0.16) * (5 - i) / 5.0;
		mesh_tint(mesh, bands[i]);
		mesh->brush.id = 51 + i;
		mesh_quad(mesh, vec3(x + 0.08, low, z + 0.035), vec3(x + width - 0.08, low + 0.0, z + 0.035),
				  vec3(x + width - 0.08, high, z + 0.035), vec3(x + 0.08, high, z + 0.035), vec3(0, 0, 1));
	}
}

static void build_room(struct mesh *mesh)
{
	static const double stand[][2] = {{0.42, 0.80}, {0.42, 0.85}, {0.10, 0.93}, {0.055, 0.98}, {0.05, 1.62}};
	mesh_material(mesh, LAYER_BRICK, 2.0);
	mesh->brush.id = 2;
	mesh_tint(mesh, 0xf0e4da);
	mesh_quad(mesh, vec3(-6, -1, -1.4), vec3(6, -1, -1.4), vec3(6, 5, -1.4), vec3(-6, 5, -1.4), vec3(0, 0, 1));
	mesh_material(mesh, LAYER_WOOD, 1.2);
	mesh->brush.id = 3;
	mesh_tint(mesh, 0xe8b888);
	mesh->transform = mat4_rotation_y(0.0);
	mesh_box(mesh, vec3(-2.6, 0.70, -1.0), vec3(2.2, 0.80, 0.95), MESH_ALL);
	mesh_material(mesh, LAYER_PAINT, 0.5);
	mesh->brush.id = 4;
	mesh_tint(mesh, 0x70a898);
	mesh_lathe(mesh, vec3(0, 0, -0.3), stand, 5, 24, 4.0);
	build_shelf(mesh);
	build_picture(mesh);
	static const double mug[][2] = {{0.10, 0.0}, {0.11, 0.26}, {0.095, 0.26}, {0.09, 0.06}, {0.0, 0.06}};
	mesh_material(mesh, LAYER_FABRIC, 0.5);
	mesh_tint(mesh, 0xe06848);
	mesh->brush.id = 60;
	mesh_lathe(mesh, vec3(-1.35, 0.80, 0.3), mug, 5, 18, 1.0);
}

static void build(struct scene *scene, struct mesh *mesh)
{
	build_fan(scene, mesh);
	stage_begin(scene, mesh, RANGE_ROOM);
	build_room(mesh);
	stage_end(scene, mesh, RANGE_ROOM);
	scene->look = (struct stage_look){
		.sun_direction = vec3_normalize(vec3(-0.55, 0.62, 0.70)),
		.sun_color = vec3(1.05, 0.92, 0.74),
		.sky_color = vec3(0.46, 0.46, 0.48),
		.bounce_color = vec3(0.28, 0.24, 0.20),
		.horizon = vec3(0.5, 0.5, 0.5),
		.zenith = vec3(0.3, 0.3, 0.3),
		.cloud_layer = -1,
		.haze = vec3(0.3, 0.28, 0.26),
		.haze_distance = 40.0,
		.fov_y = 0.80,
		.near = 0.1,
		.far = 30.0,
	};
}

static void plan(const struct scene *scene, double time, struct stage_plan *out)
{
	static const float colors[BLADES][4] = {
		{0.93f, 0.30f, 0.22f, 0}, {0.98f, 0.78f, 0.26f, 0}, {0.22f, 0.60f, 0.72f, 0}, {0.94f, 0.92f, 0.86f, 0}};
	stage_draw(out, STAGE_SOLID, RANGE_HUB, PART_HUB, 20);
	for (uint32_t k = 0; k < BLADES; k++) {
		struct stage_draw *draw = stage_draw(out, STAGE_SOLID, RANGE_BLADE, PART_BLADE + k, 30 + k);
		draw->tinted = true;
		for (int c = 0; c < 4; c++)
			draw->tint[c] = colors[k][c];
	}
	stage_draw(out, STAGE_SOLID, RANGE_HEAD, PART_HEAD, 10);
	stage_draw(out, STAGE_SOLID, RANGE_ROOM, PART_ROOM, 0);
}

static void pose(const struct scene *scene, double time, const struct stage_plan *out, struct stage_pose *pose)
{
	double turn = 2.0 * SCENE_PI * scene_phase(time, 0.8);
	struct mat4 head =
		mat4_multiply(mat4_translation(0, axis_height, 0.02), mat4_rotation_y(0.45 * scene_wave(time, 9.0, 0.0)));
	pose->view = mat4_look_at(vec3(0.55, 1.85, 3.5), vec3(0.05, 1.5, 0));
	pose->parts[PART_HEAD] = mat4_multiply(head, mat4_translation(0, 0, 0.05));
	pose->parts[PART_HUB] = mat4_multiply(head, mat4_multiply(mat4_translation(0, 0, 0.12), mat4_rotation_z(-turn)));
	for (int k = 0; k < BLADES; k++)
		pose->parts[PART_BLADE + k] =
			mat4_multiply(pose->parts[PART_HUB], mat4_rotation_z(2.0 * SCENE_PI * k / BLADES));
}

const struct stage_kind scene_fan = {
	.name = "fan",
	.description = "fast blades before a still wall",
	.materials = {MATERIAL_PLAIN, MATERIAL_BRICK, MATERIAL_WOOD, MATERIAL_FABRIC, MATERIAL_PAINT},
	.material_count = 5,
	.build = build,
	.plan = plan,
	.pose = pose,
};
