/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A lattice tower on a paved square, seen from an orbit: near bars sweep over far ones. */
#include "stage.h"

enum { LAYER_PAINT, LAYER_PAVING, LAYER_BRICK, LAYER_GRASS, LAYER_FACADE, LAYER_CLOUDS };
enum { RANGE_TOWER, RANGE_GROUND, RANGE_CITY };
enum { STAGES = 7 };

/* Half width and height of the tower's levels. */
static const double levels[STAGES + 1][2] = {{6.0, 0.6},  {4.7, 5.0},  {3.8, 9.2},  {3.1, 13.2},
											 {2.5, 17.0}, {2.0, 20.6}, {1.6, 24.0}, {0.25, 33.0}};

static struct vec3 corner(int level, int which)
{
	static const double sign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
	double r = levels[level][0];
	return vec3(sign[which & 3][0] * r, levels[level][1], sign[which & 3][1] * r);
}

static void build_stage(struct mesh *mesh, int level)
{
	double leg = 0.62 - 0.055 * level, brace = 0.30 - 0.02 * level;
	for (int k = 0; k < 4; k++) {
		struct vec3 a = corner(level, k), b = corner(level, k + 1), c = corner(level + 1, k),
					d = corner(level + 1, k + 1);
		mesh_tint(mesh, 0xc8603c);
		mesh->brush.id = (uint32_t)(10 + level * 40 + k);
		mesh_beam(mesh, a, c, leg, leg);
		if (level == STAGES - 1)
			continue;
		mesh_tint(mesh, 0xd87848);
		mesh->brush.id += 4;
		mesh_beam(mesh, c, d, brace * 1.3, brace * 1.3);
		mesh->brush.id += 4;
		mesh_beam(mesh, a, d, brace, brace * 0.5);
		mesh->brush.id += 4;
		mesh_beam(mesh, b, c, brace, brace * 0.5);
		/* From the middle of the crossing to the middle of the girder above. */
		struct vec3 half = vec3_mix(vec3_mix(a, c, 0.5), vec3_mix(b, d, 0.5), 0.5);
		mesh->brush.id += 4;
		mesh_beam(mesh, half, vec3_mix(c, d, 0.5), brace * 0.8, brace * 0.5);
		mesh->brush.id += 4;
		mesh_beam(mesh, vec3_mix(a, c, 0.5), vec3_mix(b, d, 0.5), brace * 0.8, brace * 0.5);
	}
	if (level < STAGES - 1 && level % 2 == 1) {
		mesh->brush.id = (uint32_t)(10 + level * 40 + 30);
		mesh_beam(mesh, corner(level, 0), corner(level, 2), brace, brace);
		mesh_beam(mesh, corner(level, 1), corner(level, 3), brace, brace);
	}
}

static void build_platform(struct mesh *mesh, int level, double extra)
{
	double r = levels[level][0] + extra, y = levels[level][1];
	mesh->brush.id = (uint32_t)(400 + level);
	mesh_tint(mesh, 0xb8b0a4);
	mesh_box(mesh, vec3(-r, y, -r), vec3(r, y + 0.3, r), MESH_ALL);
	mesh_tint(mesh, 0xe0a050);
	for (int k = 0; k < 4; k++) {
		struct vec3 a = corner(level, k), b = corner(level, k + 1);
		double grow = r / levels[level][0];
		struct vec3 rail_a = vec3(a.x * grow, y + 1.25, a.z * grow), rail_b = vec3(b.x * grow, y + 1.25, b.z * grow);
		mesh->brush.id = (uint32_t)(420 + level * 4 + k);
		mesh_beam(mesh, rail_a, rail_b, 0.22, 0.22);
		for (int i = 0; i < 5; i++) {
			struct vec3 p = vec3_mix(rail_a, rail_b, i / 5.0);
			mesh_beam(mesh, vec3(p.x, y, p.z), p, 0.2, 0.2);
		}
	}
}

static void build_tower(struct mesh *mesh)
{
	mesh_material(mesh, LAYER_PAINT, 2.0);
	for (int level = 0; level < STAGES; level++)
		build_stage(mesh, level);
	build_platform(mesh, 2, 1.0);
	build_platform(mesh, 6, 0.7);
	/* Stairs wind up inside. */
	mesh_tint(mesh, 0x4a78a8);
	for (int i = 0; i < 36; i++) {
		double a0 = i * SCENE_PI / 4.0, a1 = (i + 1) * SCENE_PI / 4.0, y = 0.3 + i * 0.62;
		double r = 1.3 - 0.012 * i;
		mesh->brush.id = (uint32_t)(500 + i);
		mesh_beam(mesh, vec3(r * cos(a0), y, r * sin(a0)), vec3(r * cos(a1), y + 0.62, r * sin(a1)), 0.7, 0.16);
	}
	mesh->brush.id = 499;
	mesh_tint(mesh, 0x8c98a8);
	mesh_beam(mesh, vec3(0, 0, 0), vec3(0, 24, 0), 0.5, 0.5);
	mesh_material(mesh, LAYER_BRICK, 2.0);
	mesh_tint(mesh, 0xe8dcd0);
	for (int k = 0; k < 4; k++) {
		struct vec3 c = corner(0, k);
		mesh->brush.id = (uint32_t)(480 + k);
		mesh_box(mesh, vec3(c.x - 0.9, 0, c.z - 0.9), vec3(c.x + 0.9, 1.3, c.z + 0.9), MESH_ALL & ~MESH_BOTTOM);
	}
}

static void build_ground(struct mesh *mesh)
{
	double square = 22.0, far = 260.0;
	mesh->brush.id = 1;
	mesh_material(mesh, LAYER_PAVING, 4.0);
	mesh_tint(mesh, 0xece0d0);
	mesh_quad(mesh, vec3(-square, 0, -square), vec3(square, 0, -square), vec3(square, 0, square),
			  vec3(-square, 0, square), vec3(0, 1, 0));
	mesh_material(mesh, LAYER_GRASS, 6.0);
	mesh_tint(mesh, 0xc8e0a0);
	mesh->brush.id = 2;
	for (int k = 0; k < 4; k++) {
		mesh->transform = mat4_rotation_y(k * SCENE_PI / 2.0);
		mesh_quad(mesh, vec3(-far, 0, -far), vec3(far, 0, -far), vec3(square, 0, -square), vec3(-square, 0, -square),
				  vec3(0, 1, 0));
	}
	mesh->transform = mat4_identity();
}

static void build_city(struct mesh *mesh)
{
	static const uint32_t tints[5] = {0xf0d8b8, 0xe0b090, 0xd8d0c8, 0xc0c8d8, 0xf0e8d8};
	mesh_material(mesh, LAYER_FACADE, 12.0);
	for (uint32_t i = 0; i < 44; i++) {
		double angle = 2.0 * SCENE_PI * (i + 0.6 * scene_random(i, 1)) / 44.0,
			   distance = 62.0 + 40.0 * scene_random(i, 2);
		double width = 5.0 + 5.0 * scene_random(i, 3), height = 6.0 + 12.0 * scene_random(i, 4) * scene_random(i, 5);
		mesh->transform = mat4_multiply(mat4_rotation_y(angle), mat4_translation(0, 0, -distance));
		mesh->brush.id = 600 + i;
		mesh_tint(mesh, tints[scene_hash(i) % 5]);
		mesh_material(mesh, LAYER_FACADE, 12.0);
		mesh_box(mesh, vec3(-width, 0, -width), vec3(width, height, width), MESH_LEFT | MESH_RIGHT | MESH_FRONT);
		mesh_material(mesh, LAYER_BRICK, 4.0);
		mesh_tint(mesh, 0xb06048);
		double ridge = height + width * 0.5;
		mesh_quad(mesh, vec3(-width - 0.4, height, width + 0.4), vec3(width + 0.4, height, width + 0.4),
				  vec3(width, ridge, 0), vec3(-width, ridge, 0), vec3(0, 0.9, 0.45));
		mesh_quad(mesh, vec3(-width - 0.4, height, width + 0.4), vec3(-width, ridge, 0),
				  vec3(-width - 0.4, height, -width - 0.4), vec3(-width - 0.4, height, -width), vec3(-1, 0.2, 0));
		mesh_quad(mesh, vec3(width + 0.4, height, width + 0.4), vec3(width, ridge, 0),
				  vec3(width + 0.4, height, -width - 0.4), vec3(width + 0.4, height, -width), vec3(1, 0.2, 0));
	}
	mesh->transform = mat4_identity();
}

static void build(struct scene *scene, struct mesh *mesh)
{
	stage_begin(scene, mesh, RANGE_TOWER);
	build_tower(mesh);
	stage_end(scene, mesh, RANGE_TOWER);
	stage_begin(scene, mesh, RANGE_GROUND);
	build_ground(mesh);
	stage_end(scene, mesh, RANGE_GROUND);
	stage_begin(scene, mesh, RANGE_CITY);
	build_city(mesh);
	stage_end(scene, mesh, RANGE_CITY);
	scene->look = (struct stage_look){
		.sun_direction = vec3_normalize(vec3(0.55, 0.55, 0.62)),
		.sun_color = vec3(1.30, 1.05, 0.76),
		.sky_color = vec3(0.42, 0.50, 0.64),
		.bounce_color = vec3(0.26, 0.24, 0.20),
		.horizon = vec3(0.90, 0.84, 0.74),
		.zenith = vec3(0.16, 0.36, 0.70),
		.sun_glow = vec3(0.6, 0.42, 0.22),
		.clouds = vec3(1.0, 0.96, 0.90),
		.cloud_layer = LAYER_CLOUDS,
		.haze = vec3(0.86, 0.82, 0.74),
		.haze_distance = 120.0,
		.fov_y = 0.95,
		.near = 0.3,
		.far = 400.0,
	};
}

static void plan(const struct scene *scene, double time, struct stage_plan *out)
{
	stage_draw(out, STAGE_SOLID, RANGE_TOWER, 0, 0);
	stage_draw(out, STAGE_SOLID, RANGE_GROUND, 0, 0);
	stage_draw(out, STAGE_SOLID, RANGE_CITY, 0, 0);
}

static void pose(const struct scene *scene, double time, const struct stage_plan *out, struct stage_pose *pose)
{
	double angle = 2.0 * SCENE_PI * scene_phase(time, 20.0);
	double distance = 15.5 + 2.5 * scene_wave(time, 19.0, 0.0), height = 4.6 + 2.4 * scene_wave(time, 23.0, 0.0);
	struct vec3 eye = vec3(distance * sin(angle), height, distance * cos(angle));
	pose->view = mat4_look_at(eye, vec3(0, height + 3.6 + 1.0 * scene_wave(time, 17.0, 0.2), 0));
}

const struct stage_kind scene_tower = {
	.name = "tower",
	.description = "an orbit around a lattice tower: many occlusions",
	.materials = {MATERIAL_PAINT, MATERIAL_PAVING, MATERIAL_BRICK, MATERIAL_GRASS, MATERIAL_FACADE, MATERIAL_CLOUDS},
	.material_count = 6,
	.build = build,
	.plan = plan,
	.pose = pose,
};
