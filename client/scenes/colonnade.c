/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* An endless atrium with arcades on both sides; the camera walks down the middle and looks around. */
#include "stage.h"

enum { LAYER_ASHLAR, LAYER_PAVING, LAYER_MARBLE, LAYER_PLASTER, LAYER_FABRIC, LAYER_CLOUDS };
enum { RANGE_SIDE, RANGE_DRAPE, RANGE_FLOOR };

/* Metres: one arch is a cell; the shader's shadows know these sizes too. */
static const double cell = 4.0, facade = 4.0, thick = 0.8, arch = 1.55, spring = 2.6, top = 9.6, back = 8.0;
enum { CELLS_BEHIND = 1, CELLS_AHEAD = 13 };

static void build_column(struct mesh *mesh)
{
	static const double base[][2] = {{0.50, 0.0}, {0.50, 0.18}, {0.42, 0.22}, {0.42, 0.30}, {0.33, 0.36}};
	static const double shaft[][2] = {{0.33, 0.36}, {0.28, 2.12}};
	static const double capital[][2] = {{0.28, 2.12}, {0.34, 2.16}, {0.30, 2.22}, {0.44, 2.42}};
	struct vec3 at = vec3(facade + 0.4, 0, 0);
	mesh_material(mesh, LAYER_MARBLE, 1.2);
	mesh_tint(mesh, 0xf4ead8);
	mesh->brush.open = 200;
	mesh_lathe(mesh, at, base, 5, 10, 2.0);
	mesh_tint(mesh, 0xfff6ea);
	mesh_lathe(mesh, at, shaft, 2, 12, 2.0);
	mesh_tint(mesh, 0xf0dcb8);
	mesh_lathe(mesh, at, capital, 4, 10, 2.0);
	mesh_material(mesh, LAYER_ASHLAR, 2.0);
	mesh_box(mesh, vec3(facade - 0.02, 2.42, -0.47), vec3(facade + thick, spring, 0.47), MESH_ALL & ~MESH_TOP);
}

/* The arch of the cell from z = 0 to -cell, its middle at -cell / 2. */
static void build_arch(struct mesh *mesh)
{
	enum { STEPS = 12 };
	const struct vec3 out = vec3(-1, 0, 0);
	double upper = 4.6;
	mesh->brush.open = 235;
	mesh_tint(mesh, 0xffeed2);
	for (int i = 0; i < STEPS; i++) {
		double a0 = SCENE_PI * i / STEPS, a1 = SCENE_PI * (i + 1) / STEPS;
		struct vec3 p0 = vec3(facade, spring + arch * sin(a0), -cell * 0.5 + arch * cos(a0));
		struct vec3 p1 = vec3(facade, spring + arch * sin(a1), -cell * 0.5 + arch * cos(a1));
		mesh_quad(mesh, p0, p1, vec3(facade, upper, p1.z), vec3(facade, upper, p0.z), out);
		struct vec3 in = vec3(0, -sin((a0 + a1) * 0.5), -cos((a0 + a1) * 0.5));
		struct vec3 q0 = vec3(facade + thick, p0.y, p0.z), q1 = vec3(facade + thick, p1.y, p1.z);
		mesh->brush.open = 130;
		mesh_quad(mesh, p0, p1, q1, q0, in);
		mesh->brush.open = 235;
		/* A raised moulding around the opening. */
		double grow = 1.0 + 0.16 / arch;
		struct vec3 m0 = vec3(facade - 0.07, spring + (p0.y - spring) * grow, -cell * 0.5 + (p0.z + cell * 0.5) * grow);
		struct vec3 m1 = vec3(facade - 0.07, spring + (p1.y - spring) * grow, -cell * 0.5 + (p1.z + cell * 0.5) * grow);
		mesh_quad(mesh, vec3(m0.x, p0.y, p0.z), vec3(m1.x, p1.y, p1.z), m1, m0, out);
	}
	double pier = cell * 0.5 - arch;
	mesh_quad(mesh, vec3(facade, spring, 0.003), vec3(facade, spring, -pier), vec3(facade, upper, -pier),
			  vec3(facade, upper, 0.003), out);
	mesh_quad(mesh, vec3(facade, spring, -cell), vec3(facade, spring, -cell + pier), vec3(facade, upper, -cell + pier),
			  vec3(facade, upper, -cell), out);
}

static void build_window(struct mesh *mesh, double z, double low, double high, double half)
{
	double deep = facade + 0.35;
	mesh->brush.open = 120;
	mesh_tint(mesh, 0xffe9cc);
	mesh_quad(mesh, vec3(facade, low, z - half), vec3(deep, low, z - half), vec3(deep, high, z - half),
			  vec3(facade, high, z - half), vec3(0, 0, 1));
	mesh_quad(mesh, vec3(facade, low, z + half), vec3(deep, low, z + half), vec3(deep, high, z + half),
			  vec3(facade, high, z + half), vec3(0, 0, -1));
	mesh_quad(mesh, vec3(facade, low, z - half), vec3(deep, low, z - half), vec3(deep, low, z + half),
			  vec3(facade, low, z + half), vec3(0, 1, 0));
	mesh_quad(mesh, vec3(facade, high, z - half), vec3(deep, high, z - half), vec3(deep, high, z + half),
			  vec3(facade, high, z + half), vec3(0, -1, 0));
	mesh_material(mesh, LAYER_PLASTER, 2.0);
	mesh_tint(mesh, 0x5a6f86);
	mesh_quad(mesh, vec3(deep, low, z - half), vec3(deep, low, z + half), vec3(deep, high, z + half),
			  vec3(deep, high, z - half), vec3(-1, 0, 0));
	mesh_material(mesh, LAYER_ASHLAR, 2.0);
}

static void build_upper_wall(struct mesh *mesh)
{
	double low = 4.86, sill = 5.7, head = 7.7, half = 0.55, z = -cell * 0.5, eaves = 9.1;
	const struct vec3 out = vec3(-1, 0, 0);
	mesh->brush.open = 255;
	mesh_tint(mesh, 0xffe2bc);
	const double edges[4] = {0.003, z + half, z - half, -cell};
	for (int i = 0; i < 3; i++) {
		double z0 = edges[i], z1 = edges[i + 1];
		if (i != 1) {
			mesh_quad(mesh, vec3(facade, low, z0), vec3(facade, low, z1), vec3(facade, eaves, z1),
					  vec3(facade, eaves, z0), out);
			continue;
		}
		mesh_quad(mesh, vec3(facade, low, z0), vec3(facade, low, z1), vec3(facade, sill, z1), vec3(facade, sill, z0),
				  out);
		mesh_quad(mesh, vec3(facade, head, z0), vec3(facade, head, z1), vec3(facade, eaves, z1),
				  vec3(facade, eaves, z0), out);
	}
	build_window(mesh, z, sill, head, half);
	mesh->brush.open = 255;
	mesh_tint(mesh, 0xfff2dc);
	mesh_box(mesh, vec3(facade - 0.16, 4.6, -cell), vec3(facade, low, 0.003), MESH_LEFT | MESH_TOP | MESH_BOTTOM);
	mesh_box(mesh, vec3(facade - 0.12, sill - 0.16, z - half - 0.14), vec3(facade, sill, z + half + 0.14),
			 MESH_ALL & ~MESH_RIGHT);
	mesh_box(mesh, vec3(facade - 0.09, head, z - half - 0.14), vec3(facade, head + 0.2, z + half + 0.14),
			 MESH_ALL & ~MESH_RIGHT);
	mesh_box(mesh, vec3(facade - 0.34, eaves, -cell), vec3(facade, top, 0.003), MESH_LEFT | MESH_TOP | MESH_BOTTOM);
}

static void build_gallery(struct mesh *mesh)
{
	mesh_material(mesh, LAYER_PLASTER, 2.0);
	mesh->brush.open = 120;
	mesh_tint(mesh, 0xf0b98a);
	mesh_quad(mesh, vec3(back, 1.1, 0.003), vec3(back, 1.1, -cell), vec3(back, 4.7, -cell), vec3(back, 4.7, 0.003),
			  vec3(-1, 0, 0));
	mesh->brush.open = 100;
	mesh_tint(mesh, 0x9a4a38);
	mesh_quad(mesh, vec3(back, 0.0, 0.003), vec3(back, 0.0, -cell), vec3(back, 1.1, -cell), vec3(back, 1.1, 0.003),
			  vec3(-1, 0, 0));
	mesh->brush.open = 110;
	mesh_tint(mesh, 0xd8c8b0);
	mesh_quad(mesh, vec3(facade, 4.6, 0.003), vec3(facade, 4.6, -cell), vec3(back, 4.6, -cell), vec3(back, 4.6, 0.003),
			  vec3(0, -1, 0));
}

/* A sagging cloth under the windows, lit from both sides. */
static void build_drape(struct mesh *mesh)
{
	enum { ACROSS = 8, DOWN = 3 };
	uint32_t v[DOWN + 1][ACROSS + 1];
	mesh_material(mesh, LAYER_FABRIC, 1.0);
	mesh_tint(mesh, 0xffffff);
	mesh->brush.open = 255;
	mesh->brush.id = 9;
	for (int j = 0; j <= DOWN; j++) {
		for (int i = 0; i <= ACROSS; i++) {
			double u = (double)i / ACROSS, d = (double)j / DOWN, fold = sin(u * 25.13);
			struct vec3 p = vec3(facade - 0.24 - 0.05 * fold, 5.5 - 2.0 * d - 0.25 * d * sin(u * SCENE_PI),
								 -cell * 0.5 + (u - 0.5) * 1.9);
			mesh->brush.sway = (uint8_t)(255.0 * d * d);
			mesh->brush.sway_phase = (uint8_t)(u * 90.0);
			v[j][i] = mesh_add_vertex(mesh, p, vec3(-1, 0, 0.45 * cos(u * 25.13)), u, d);
		}
	}
	mesh->brush.sway = 0;
	for (int j = 0; j < DOWN; j++) {
		for (int i = 0; i < ACROSS; i++) {
			mesh_add_triangle(mesh, v[j][i], v[j][i + 1], v[j + 1][i + 1]);
			mesh_add_triangle(mesh, v[j][i], v[j + 1][i + 1], v[j + 1][i]);
		}
	}
}

static void build_floor(struct mesh *mesh)
{
	double near = cell * 2.0, far = -cell * (CELLS_AHEAD + 1), side = facade + 0.05;
	mesh->brush.id = 1;
	mesh->brush.open = 230;
	mesh_material(mesh, LAYER_PAVING, 2.0);
	mesh_tint(mesh, 0xf2e6d6);
	mesh_quad(mesh, vec3(-2.6, 0, near), vec3(2.6, 0, near), vec3(2.6, 0, far), vec3(-2.6, 0, far), vec3(0, 1, 0));
	mesh_tint(mesh, 0xc08a6a);
	for (int s = -1; s <= 1; s += 2) {
		mesh->brush.open = 200;
		mesh_quad(mesh, vec3(2.6 * s, 0, near), vec3(side * s, 0, near), vec3(side * s, 0, far), vec3(2.6 * s, 0, far),
				  vec3(0, 1, 0));
		mesh->brush.open = 110;
		mesh_quad(mesh, vec3(side * s, 0, near), vec3(back * s, 0, near), vec3(back * s, 0, far),
				  vec3(side * s, 0, far), vec3(0, 1, 0));
	}
}

static void build(struct scene *scene, struct mesh *mesh)
{
	for (uint32_t side = 0; side < 2; side++) {
		/* Half a turn about y, about the middle of the cell, makes the left side from the right one. */
		mesh->transform = mat4_identity();
		if (side)
			mesh->transform = mat4_multiply(mat4_translation(0, 0, -cell), mat4_rotation_y(SCENE_PI));
		stage_begin(scene, mesh, RANGE_SIDE + side * 8);
		mesh->brush.id = 10 + side;
		build_column(mesh);
		mesh->brush.id = 12 + side;
		build_arch(mesh);
		mesh->brush.id = 14 + side;
		build_upper_wall(mesh);
		mesh->brush.id = 16 + side;
		build_gallery(mesh);
		stage_end(scene, mesh, RANGE_SIDE + side * 8);
		stage_begin(scene, mesh, RANGE_DRAPE + side * 8);
		build_drape(mesh);
		stage_end(scene, mesh, RANGE_DRAPE + side * 8);
	}
	mesh->transform = mat4_identity();
	stage_begin(scene, mesh, RANGE_FLOOR);
	build_floor(mesh);
	stage_end(scene, mesh, RANGE_FLOOR);
	scene->look = (struct stage_look){
		.sun_direction = vec3_normalize(vec3(0.42, 0.82, 0.30)),
		.sun_color = vec3(1.35, 1.12, 0.82),
		.sky_color = vec3(0.46, 0.54, 0.68),
		.bounce_color = vec3(0.42, 0.33, 0.24),
		.horizon = vec3(0.80, 0.86, 0.92),
		.zenith = vec3(0.13, 0.33, 0.70),
		.sun_glow = vec3(0.5, 0.42, 0.28),
		.clouds = vec3(0.98, 0.97, 0.95),
		.cloud_layer = LAYER_CLOUDS,
		.haze = vec3(0.80, 0.80, 0.78),
		.haze_distance = 46.0,
		.sway_size = vec3(0.10, 0.02, 0.05),
		.fov_y = 1.05,
		.near = 0.1,
		.far = 120.0,
	};
}

static double walked(double time)
{
	return 3.0 * time;
}

static void plan(const struct scene *scene, double time, struct stage_plan *out)
{
	static const float colors[5][4] = {{0.86f, 0.16f, 0.13f, 0},
									   {0.15f, 0.42f, 0.66f, 0},
									   {0.93f, 0.66f, 0.16f, 0},
									   {0.16f, 0.52f, 0.34f, 0},
									   {0.62f, 0.18f, 0.42f, 0}};
	out->cell = floor(walked(time) / cell);
	out->origin = vec3(0, 0, -out->cell * cell);
	for (int k = 0; k < CELLS_BEHIND + CELLS_AHEAD; k++) {
		uint32_t number = (uint32_t)(int64_t)fmod(out->cell + k - CELLS_BEHIND, 65536.0) + 65536u;
		for (uint32_t side = 0; side < 2; side++)
			stage_draw(out, STAGE_COLONNADE, RANGE_SIDE + side * 8, (uint32_t)k, number * 64);
	}
	stage_draw(out, STAGE_COLONNADE, RANGE_FLOOR, STAGE_PARTS - 1, 0);
	for (int k = 0; k < CELLS_BEHIND + CELLS_AHEAD; k++) {
		uint32_t number = (uint32_t)(int64_t)fmod(out->cell + k - CELLS_BEHIND, 65536.0) + 65536u;
		for (uint32_t side = 0; side < 2; side++) {
			uint32_t dice = scene_hash2(number, side);
			if (dice % 4 == 0)
				continue;
			struct stage_draw *draw =
				stage_draw(out, STAGE_COLONNADE, RANGE_DRAPE + side * 8, (uint32_t)k, number * 64 + 32 + side);
			draw->tinted = true;
			for (int c = 0; c < 4; c++)
				draw->tint[c] = colors[(dice >> 8) % 5][c];
		}
	}
}

static void pose(const struct scene *scene, double time, const struct stage_plan *out, struct stage_pose *pose)
{
	struct vec3 eye = vec3(1.5 * scene_wave(time, 23.0, 0.05), 1.75 + 0.04 * scene_wave(time, 1.05, 0.0),
						   -(walked(time) - out->cell * cell));
	double yaw = 0.42 * scene_wave(time, 13.0, 0.12) + 0.16 * scene_wave(time, 7.3, 0.4);
	double pitch = 0.10 + 0.09 * scene_wave(time, 17.0, 0.3);
	struct vec3 ahead = vec3(sin(yaw) * cos(pitch), sin(pitch), -cos(yaw) * cos(pitch));
	pose->view = mat4_look_at(eye, vec3_add(eye, ahead));
	for (int k = 0; k < CELLS_BEHIND + CELLS_AHEAD; k++)
		pose->parts[k] = mat4_translation(0, 0, -cell * (k - CELLS_BEHIND));
	pose->sway[0] = 2.0 * SCENE_PI * scene_phase(time, 3.1);
	pose->sway[1] = 2.0 * SCENE_PI * scene_phase(time, 2.3);
}

const struct stage_kind scene_colonnade = {
	.name = "colonnade",
	.description = "a walk through a sunny arcade with fine stone",
	.materials = {MATERIAL_ASHLAR, MATERIAL_PAVING, MATERIAL_MARBLE, MATERIAL_PLASTER, MATERIAL_FABRIC,
				  MATERIAL_CLOUDS},
	.material_count = 6,
	.build = build,
	.plan = plan,
	.pose = pose,
};
