/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* An endless birch wood; the camera walks sideways, so near trunks sweep over many layers behind. */
#include "stage.h"

enum { LAYER_BARK, LAYER_LEAVES, LAYER_GRASS, LAYER_TUFT, LAYER_CLOUDS };
enum { VARIANTS = 5, BANDS = 3, RANGE_SOLID = 0, RANGE_CUTOUT = 20, RANGE_GROUND = 40 };
enum { CELLS = 13, MIDDLE = 6 };

static const double cell = 6.0;

/* Metres from the camera's path, and trees in a cell. */
static const struct {
	double near, far;
	uint32_t trees;
} bands[BANDS] = {{4.0, 8.0, 1}, {8.5, 16.0, 2}, {17.0, 34.0, 4}};

static uint32_t seed_of(uint32_t variant, uint32_t band, uint32_t tree)
{
	return scene_hash(variant * 64 + band * 16 + tree + 1000);
}

struct tree {
	struct vec3 root;
	double height, radius, lean_x, lean_z;
	uint32_t seed;
};

static struct tree make_tree(uint32_t variant, uint32_t band, uint32_t number)
{
	uint32_t seed = seed_of(variant, band, number);
	double across = (number + 0.15 + 0.7 * scene_random(seed, 1)) / bands[band].trees;
	double depth = bands[band].near + (bands[band].far - bands[band].near) * scene_random(seed, 2);
	struct tree tree = {.root = vec3(cell * (across - 0.5), 0, -depth), .seed = seed};
	tree.height = 7.5 + 3.5 * scene_random(seed, 3);
	tree.radius = 0.13 + 0.07 * scene_random(seed, 4);
	tree.lean_x = (scene_random(seed, 5) - 0.5) * 1.1;
	tree.lean_z = (scene_random(seed, 6) - 0.5) * 0.8;
	return tree;
}

/* Where the trunk's middle is at part t of its height. */
static struct vec3 trunk_at(const struct tree *tree, double t)
{
	return vec3(tree->root.x + tree->lean_x * t * t, tree->height * t, tree->root.z + tree->lean_z * t * t);
}

static void build_trunk(struct mesh *mesh, const struct tree *tree, int segments)
{
	enum { STEPS = 4 };
	uint32_t before[13] = {0};
	for (int j = 0; j <= STEPS; j++) {
		double t = (double)j / STEPS, r = tree->radius * (1.0 - 0.72 * t) * (j == 0 ? 1.35 : 1.0);
		struct vec3 middle = trunk_at(tree, t);
		for (int i = 0; i <= segments; i++) {
			double a = 2.0 * SCENE_PI * i / segments;
			struct vec3 n = vec3(cos(a), 0, sin(a));
			uint32_t v = mesh_add_vertex(mesh, vec3_add(middle, vec3_scale(n, r)), n, (double)i / segments,
										 tree->height * t / 1.6 + scene_random(tree->seed, 9));
			if (j > 0 && i > 0) {
				mesh_add_triangle(mesh, before[i - 1], before[i], v);
				mesh_add_triangle(mesh, before[i - 1], v, v - 1);
			}
			if (i > 0)
				before[i - 1] = v - 1;
			if (i == segments)
				before[i] = v;
		}
	}
}

static struct vec3 branch_end(const struct tree *tree, uint32_t k, struct vec3 *start)
{
	double t = 0.34 + 0.6 * (k + scene_random(tree->seed, 20 + k)) / 7.0,
		   angle = 2.4 * k + 6.28 * scene_random(tree->seed, 7);
	double length = 0.8 + 1.3 * (1.0 - t) + 0.4 * scene_random(tree->seed, 30 + k);
	*start = trunk_at(tree, t);
	return vec3_add(*start, vec3(length * cos(angle), length * 0.62, length * sin(angle)));
}

static void build_wood(struct mesh *mesh, const struct tree *tree, uint32_t band)
{
	mesh_material(mesh, LAYER_BARK, 1.0);
	mesh_tint(mesh, scene_random(tree->seed, 8) > 0.4 ? 0xfff6ea : 0xe8dccc);
	mesh->brush.open = 230;
	build_trunk(mesh, tree, band == 0 ? 10 : band == 1 ? 7 : 5);
	mesh_tint(mesh, 0x8a7464);
	for (uint32_t k = 0; k < 6 - band; k++) {
		struct vec3 start, end = branch_end(tree, k, &start);
		mesh_beam(mesh, start, end, 0.075 + 0.02 * band, 0.075);
	}
}

static void build_leaves(struct mesh *mesh, const struct tree *tree, uint32_t band)
{
	static const uint32_t tints[5] = {0xc8e070, 0xe8e468, 0xf8d050, 0xf4b444, 0xb4d468};
	uint32_t count = band == 0 ? 12 : band == 1 ? 8 : 5;
	double size = 1.05 + 0.45 * band;
	mesh_material(mesh, LAYER_LEAVES, 1.0);
	mesh->brush.open = 255;
	for (uint32_t k = 0; k < count; k++) {
		struct vec3 start, end = branch_end(tree, k % 7, &start);
		struct vec3 at = vec3_mix(start, end, 0.55 + 0.6 * scene_random(tree->seed, 40 + k));
		double spin = 6.28 * scene_random(tree->seed, 60 + k), yaw = 1.6 * (scene_random(tree->seed, 80 + k) - 0.5);
		struct vec3 right = vec3(size * cos(spin) * cos(yaw), size * sin(spin), size * cos(spin) * sin(yaw));
		struct vec3 up = vec3(-size * sin(spin) * cos(yaw), size * cos(spin), -size * sin(spin) * sin(yaw));
		mesh_tint(mesh, tints[scene_hash2(tree->seed, k) % 5]);
		mesh->brush.sway = 200;
		mesh->brush.sway_phase = (uint8_t)scene_hash2(k, tree->seed);
		mesh_card(mesh, at, right, up, vec3(0.3 * cos(spin), 0.75, 0.6));
	}
	mesh->brush.sway = 0;
}

static void build_tufts(struct mesh *mesh, uint32_t variant, uint32_t band)
{
	static const uint32_t tints[3] = {0xa8c860, 0xc8d070, 0xe0c468};
	mesh_material(mesh, LAYER_TUFT, 1.0);
	for (uint32_t k = 0; k < (band == 0 ? 7 : band == 1 ? 6 : 0); k++) {
		uint32_t seed = seed_of(variant, band, k) + 7;
		double depth = bands[band].near - 1.2 + (bands[band].far - bands[band].near) * scene_random(seed, 1);
		double size = 0.55 + 0.5 * scene_random(seed, 3);
		struct vec3 at = vec3(cell * (scene_random(seed, 2) - 0.5), size * 0.46, -depth);
		mesh->brush.id = 200 + band * 16 + k;
		mesh_tint(mesh, tints[scene_hash(seed) % 3]);
		mesh->brush.sway = 90;
		mesh->brush.sway_phase = (uint8_t)scene_hash(seed + 1);
		mesh_card(mesh, at, vec3(size * 1.2, 0, 0.3 * (scene_random(seed, 4) - 0.5)), vec3(0, size, 0),
				  vec3(0, 1, 0.3));
	}
	mesh->brush.sway = 0;
}

static void build_variant(struct scene *scene, struct mesh *mesh, uint32_t variant, uint32_t band)
{
	uint32_t offset = variant * BANDS + band;
	stage_begin(scene, mesh, RANGE_SOLID + offset);
	for (uint32_t i = 0; i < bands[band].trees; i++) {
		struct tree tree = make_tree(variant, band, i);
		mesh->brush.id = 10 + band * 16 + i * 2;
		build_wood(mesh, &tree, band);
	}
	stage_end(scene, mesh, RANGE_SOLID + offset);
	stage_begin(scene, mesh, RANGE_CUTOUT + offset);
	for (uint32_t i = 0; i < bands[band].trees; i++) {
		struct tree tree = make_tree(variant, band, i);
		mesh->brush.id = 11 + band * 16 + i * 2;
		build_leaves(mesh, &tree, band);
	}
	build_tufts(mesh, variant, band);
	stage_end(scene, mesh, RANGE_CUTOUT + offset);
}

static void build(struct scene *scene, struct mesh *mesh)
{
	for (uint32_t variant = 0; variant < VARIANTS; variant++) {
		for (uint32_t band = 0; band < BANDS; band++)
			build_variant(scene, mesh, variant, band);
	}
	stage_begin(scene, mesh, RANGE_GROUND);
	mesh->brush.id = 1;
	mesh->brush.open = 255;
	mesh_material(mesh, LAYER_GRASS, 3.0);
	mesh_tint(mesh, 0xd8dcb0);
	mesh_quad(mesh, vec3(-90, 0, 4), vec3(90, 0, 4), vec3(90, 0, -90), vec3(-90, 0, -90), vec3(0, 1, 0));
	stage_end(scene, mesh, RANGE_GROUND);
	scene->look = (struct stage_look){
		.sun_direction = vec3_normalize(vec3(-0.62, 0.60, 0.38)),
		.sun_color = vec3(1.15, 0.98, 0.66),
		.sky_color = vec3(0.44, 0.50, 0.52),
		.bounce_color = vec3(0.24, 0.24, 0.14),
		.horizon = vec3(0.86, 0.86, 0.70),
		.zenith = vec3(0.30, 0.50, 0.76),
		.sun_glow = vec3(0.4, 0.36, 0.2),
		.clouds = vec3(1.0, 0.98, 0.92),
		.cloud_layer = LAYER_CLOUDS,
		.haze = vec3(0.84, 0.84, 0.66),
		.haze_distance = 34.0,
		.sway_size = vec3(0.14, 0.05, 0.0),
		.fov_y = 0.92,
		.near = 0.2,
		.far = 140.0,
	};
}

static double walked(double time)
{
	return 3.4 * time;
}

/* Cells from the middle outwards, bands from near to far. */
static void plan_band(const struct stage_plan *plan, struct stage_plan *out, enum stage_program program, uint32_t first,
					  uint32_t band)
{
	for (int i = 0; i < CELLS; i++) {
		int k = MIDDLE + ((i & 1) ? (i + 1) / 2 : -i / 2);
		if (band == 0 && (k < MIDDLE - 2 || k > MIDDLE + 2))
			continue;
		if (band == 1 && (k < MIDDLE - 4 || k > MIDDLE + 4))
			continue;
		uint32_t number = (uint32_t)(int64_t)fmod(plan->cell + k, 65536.0) + 65536u;
		stage_draw(out, program, first + scene_hash(number) % VARIANTS * BANDS + band, (uint32_t)k, number * 256);
	}
}

static void plan(const struct scene *scene, double time, struct stage_plan *out)
{
	out->cell = floor(walked(time) / cell);
	plan_band(out, out, STAGE_SOLID, RANGE_SOLID, 0);
	plan_band(out, out, STAGE_SOLID, RANGE_SOLID, 1);
	plan_band(out, out, STAGE_CUTOUT, RANGE_CUTOUT, 0);
	plan_band(out, out, STAGE_CUTOUT, RANGE_CUTOUT, 1);
	plan_band(out, out, STAGE_SOLID, RANGE_SOLID, 2);
	stage_draw(out, STAGE_SOLID, RANGE_GROUND, STAGE_PARTS - 1, 0);
	plan_band(out, out, STAGE_CUTOUT, RANGE_CUTOUT, 2);
}

static void pose(const struct scene *scene, double time, const struct stage_plan *out, struct stage_pose *pose)
{
	struct vec3 eye =
		vec3(walked(time) - out->cell * cell, 1.7 + 0.03 * scene_wave(time, 1.1, 0.0), 0.5 * scene_wave(time, 19.0, 0));
	double yaw = 0.22 * scene_wave(time, 15.0, 0.1), pitch = 0.12 + 0.05 * scene_wave(time, 11.0, 0.4);
	pose->view = mat4_look_at(eye, vec3_add(eye, vec3(sin(yaw), sin(pitch), -cos(yaw))));
	for (int k = 0; k < CELLS; k++)
		pose->parts[k] = mat4_translation(cell * (k - MIDDLE), 0, 0);
	pose->sway[0] = 2.0 * SCENE_PI * scene_phase(time, 2.7);
	pose->sway[1] = 2.0 * SCENE_PI * scene_phase(time, 1.9);
}

const struct stage_kind scene_trees = {
	.name = "trees",
	.description = "a birch wood passing by: many thin layers",
	.materials = {MATERIAL_BARK, MATERIAL_LEAVES, MATERIAL_GRASS, MATERIAL_TUFT, MATERIAL_CLOUDS},
	.material_count = 5,
	.build = build,
	.plan = plan,
	.pose = pose,
};
