/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A still life on a wooden table before a plastered wall. Nothing moves, ever. */
#include "stage.h"

enum { LAYER_PLAIN, LAYER_PLASTER, LAYER_WOOD, LAYER_FABRIC, LAYER_MARBLE, LAYER_BRICK };
enum { RANGE_ALL };

static const double table = 0.0;

static void build_vessels(struct mesh *mesh)
{
	static const double jug[][2] = {{0.12, 0.0},  {0.19, 0.06}, {0.24, 0.20},  {0.22, 0.36}, {0.13, 0.50},
									{0.10, 0.60}, {0.13, 0.70}, {0.115, 0.70}, {0.09, 0.60}};
	static const double bowl[][2] = {{0.12, 0.0},  {0.10, 0.03}, {0.24, 0.10}, {0.34, 0.22},
									 {0.32, 0.22}, {0.22, 0.12}, {0.0, 0.08}};
	static const double bottle[][2] = {{0.11, 0.0},   {0.115, 0.42}, {0.10, 0.52}, {0.04, 0.64},
									   {0.036, 0.80}, {0.05, 0.80},  {0.05, 0.86}, {0.0, 0.86}};
	mesh->brush.id = 10;
	mesh_material(mesh, LAYER_FABRIC, 0.75);
	mesh_tint(mesh, 0x5f8fb8);
	mesh_lathe(mesh, vec3(-0.62, table, -0.12), jug, 9, 28, 2.0);
	mesh->brush.id = 11;
	mesh_material(mesh, LAYER_MARBLE, 0.5);
	mesh_tint(mesh, 0xf6e8d2);
	mesh_lathe(mesh, vec3(0.12, table, 0.05), bowl, 7, 32, 4.0);
	mesh->brush.id = 12;
	mesh_material(mesh, LAYER_PLAIN, 0.8);
	mesh_tint(mesh, 0x3c6a4c);
	mesh_lathe(mesh, vec3(0.72, table, -0.32), bottle, 8, 24, 1.0);
	mesh->brush.id = 13;
	mesh_tint(mesh, 0xf0dca8);
	mesh_lathe(mesh, vec3(0.72, table + 0.14, -0.32), (const double[][2]){{0.1175, 0.0}, {0.1175, 0.18}}, 2, 24, 3.0);
}

static void build_fruit(struct mesh *mesh)
{
	static const struct {
		double x, y, z, radius;
		uint32_t tint;
	} fruit[] = {{0.02, 0.22, 0.10, 0.105, 0xf09030},   {0.22, 0.22, 0.12, 0.10, 0xe87828},
				 {0.13, 0.22, -0.08, 0.105, 0xf4a038},  {0.12, 0.36, 0.05, 0.10, 0xd84030},
				 {-0.22, 0.095, 0.36, 0.095, 0xc83830}, {0.52, 0.10, 0.30, 0.10, 0xf0b840},
				 {0.70, 0.085, 0.18, 0.085, 0xa8c048}};
	mesh_material(mesh, LAYER_PLAIN, 0.3);
	for (uint32_t i = 0; i < sizeof(fruit) / sizeof(fruit[0]); i++) {
		mesh->brush.id = 20 + i;
		mesh_tint(mesh, fruit[i].tint);
		double r = fruit[i].radius;
		mesh_ellipsoid(mesh, vec3(fruit[i].x, table + fruit[i].y, fruit[i].z), vec3(r, r * 0.94, r), 20, 12);
		mesh_tint(mesh, 0x5a4428);
		mesh->brush.id = 40 + i;
		mesh_limb(mesh, vec3(fruit[i].x, table + fruit[i].y + r * 0.86, fruit[i].z), 0.012,
				  vec3(fruit[i].x + 0.02, table + fruit[i].y + r * 1.15, fruit[i].z + 0.01), 0.009, 6);
	}
}

/* Soft dark patches under things: a fan whose rim is as bright as the table. */
static void build_shadow(struct mesh *mesh, double x, double z, double radius)
{
	enum { STEPS = 20 };
	struct vec3 up = vec3(0, 1, 0), middle = vec3(x + radius * 0.15, table + 0.002, z - radius * 0.1);
	uint32_t first = (uint32_t)mesh->vertex_count;
	mesh_tint(mesh, 0x4a3c30);
	mesh_add_vertex(mesh, middle, up, middle.x / 1.2, middle.z / 1.2);
	for (int ring = 0; ring < 2; ring++) {
		mesh_tint(mesh, ring ? 0xd8a878 : 0x6a543f);
		for (int i = 0; i <= STEPS; i++) {
			double a = 2.0 * SCENE_PI * i / STEPS, r = radius * (ring ? 1.65 : 0.95);
			struct vec3 p = vec3(middle.x + r * cos(a), middle.y, middle.z + r * sin(a));
			mesh_add_vertex(mesh, p, up, p.x / 1.2, p.z / 1.2);
		}
	}
	for (uint32_t i = 0; i < STEPS && !mesh->failed; i++) {
		uint32_t a = first + 1 + i, b = a + STEPS + 1;
		mesh_add_triangle(mesh, first, a, a + 1);
		mesh_add_triangle(mesh, a, b, b + 1);
		mesh_add_triangle(mesh, a, b + 1, a + 1);
	}
}

static void build_cloth(struct mesh *mesh)
{
	enum { ACROSS = 16, DOWN = 10 };
	uint32_t v[DOWN + 1][ACROSS + 1];
	mesh->brush.id = 5;
	mesh_material(mesh, LAYER_FABRIC, 0.5);
	mesh_tint(mesh, 0xd86a58);
	for (int j = 0; j <= DOWN; j++) {
		for (int i = 0; i <= ACROSS; i++) {
			double u = (double)i / ACROSS, d = (double)j / DOWN, x = -0.52 + 0.95 * u + 0.08 * d,
				   over = fmax(0.0, d - 0.55) / 0.45;
			double fold = sin(u * 19.0) * 0.02 * over;
			struct vec3 p =
				vec3(x, table + 0.006 - 0.5 * over * over * 0.9 + 0.012 * sin(u * 7.0 + d * 5.0) * (1 - over) + 0.012,
					 0.24 + 0.59 * fmin(d / 0.55, 1.0) + 0.03 * over + fold);
			v[j][i] =
				mesh_add_vertex(mesh, p, vec3(-cos(u * 19.0) * 0.5 * over, 1.0 - over * 0.85, over), u * 2.0, d * 2.0);
		}
	}
	for (int j = 0; j < DOWN; j++) {
		for (int i = 0; i < ACROSS; i++) {
			mesh_add_triangle(mesh, v[j][i], v[j][i + 1], v[j + 1][i + 1]);
			mesh_add_triangle(mesh, v[j][i], v[j + 1][i + 1], v[j + 1][i]);
		}
	}
}

static void build_room(struct mesh *mesh)
{
	mesh->brush.id = 1;
	mesh_material(mesh, LAYER_PLASTER, 1.6);
	mesh_tint(mesh, 0x9cb0a8);
	mesh_quad(mesh, vec3(-4, 0.1, -0.9), vec3(4, 0.1, -0.9), vec3(4, 3, -0.9), vec3(-4, 3, -0.9), vec3(0, 0, 1));
	mesh->brush.id = 2;
	mesh_material(mesh, LAYER_BRICK, 1.2);
	mesh_tint(mesh, 0xd8ccc0);
	mesh_quad(mesh, vec3(-4, -2, -0.88), vec3(4, -2, -0.88), vec3(4, 0.12, -0.88), vec3(-4, 0.12, -0.88),
			  vec3(0, 0, 1));
	mesh->brush.id = 3;
	mesh_material(mesh, LAYER_WOOD, 1.2);
	mesh_tint(mesh, 0xd8a878);
	mesh_box(mesh, vec3(-1.5, table - 0.09, -0.7), vec3(1.5, table, 0.8), MESH_ALL);
	build_shadow(mesh, -0.62, -0.12, 0.24);
	build_shadow(mesh, 0.12, 0.05, 0.26);
	build_shadow(mesh, 0.72, -0.32, 0.13);
	build_shadow(mesh, 0.52, 0.30, 0.09);
	build_shadow(mesh, 0.70, 0.18, 0.07);
}

static void build(struct scene *scene, struct mesh *mesh)
{
	stage_begin(scene, mesh, RANGE_ALL);
	build_vessels(mesh);
	build_fruit(mesh);
	build_cloth(mesh);
	build_room(mesh);
	stage_end(scene, mesh, RANGE_ALL);
	scene->look = (struct stage_look){
		.sun_direction = vec3_normalize(vec3(-0.75, 0.55, 0.60)),
		.sun_color = vec3(1.15, 0.96, 0.70),
		.sky_color = vec3(0.36, 0.40, 0.46),
		.bounce_color = vec3(0.22, 0.16, 0.12),
		.horizon = vec3(0.2, 0.2, 0.2),
		.zenith = vec3(0.2, 0.2, 0.2),
		.cloud_layer = -1,
		.haze = vec3(0.1, 0.1, 0.1),
		.haze_distance = 40.0,
		.fov_y = 0.62,
		.near = 0.1,
		.far = 20.0,
	};
}

static void plan(const struct scene *scene, double time, struct stage_plan *out)
{
	stage_draw(out, STAGE_SOLID, RANGE_ALL, 0, 0);
}

static void pose(const struct scene *scene, double time, const struct stage_plan *out, struct stage_pose *pose)
{
	pose->view = mat4_look_at(vec3(0.25, 0.85, 2.35), vec3(0.03, 0.25, 0));
}

const struct stage_kind scene_still = {
	.name = "still",
	.description = "a still life: nothing moves",
	.materials = {MATERIAL_PLAIN, MATERIAL_PLASTER, MATERIAL_WOOD, MATERIAL_FABRIC, MATERIAL_MARBLE, MATERIAL_BRICK},
	.material_count = 6,
	.build = build,
	.plan = plan,
	.pose = pose,
};
