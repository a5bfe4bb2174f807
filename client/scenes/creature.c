/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A camel walks through dunes; the camera keeps beside it. Every limb moves in its own way. */
#include "stage.h"

enum { LAYER_FUR, LAYER_SAND, LAYER_FABRIC, LAYER_PLAIN, LAYER_TUFT, LAYER_CLOUDS };
enum {
	RANGE_BODY,
	RANGE_NECK,
	RANGE_HEAD,
	RANGE_JAW,
	RANGE_TAIL,
	RANGE_THIGH,
	RANGE_SHIN,
	RANGE_FOOT,
	RANGE_GROUND,
	RANGE_ROCKS,
	VARIANTS = 4,
	RANGE_TUFTS = RANGE_ROCKS + VARIANTS
};
enum { PART_BODY, PART_NECK, PART_UPPER_NECK, PART_HEAD, PART_JAW, PART_TAIL, PART_LEGS, PART_CELLS = PART_LEGS + 12 };
enum { CELLS = 15, MIDDLE = 7 };

static const double cell = 6.0, thigh = 0.86, shin = 0.84, ankle = 0.10;
static const double period = 1.15, stride = 1.10, stance = 0.62;

static double walked(double time)
{
	return stride / (stance * period) * time;
}

static void build_body(struct mesh *mesh)
{
	mesh_material(mesh, LAYER_FUR, 0.9);
	mesh_tint(mesh, 0xe2ae72);
	mesh->brush.id = 10;
	mesh->brush.open = 220;
	mesh_ellipsoid(mesh, vec3(0, 0, 0), vec3(0.98, 0.52, 0.44), 20, 12);
	mesh_ellipsoid(mesh, vec3(0.62, 0.02, 0), vec3(0.46, 0.50, 0.39), 14, 10);
	mesh_ellipsoid(mesh, vec3(-0.66, -0.02, 0), vec3(0.44, 0.47, 0.39), 14, 10);
	mesh_tint(mesh, 0xd09858);
	mesh_ellipsoid(mesh, vec3(0.40, 0.50, 0), vec3(0.30, 0.34, 0.22), 14, 10);
	mesh_ellipsoid(mesh, vec3(-0.42, 0.50, 0), vec3(0.32, 0.36, 0.23), 14, 10);
	mesh_tint(mesh, 0xb87c44);
	mesh_ellipsoid(mesh, vec3(0.40, 0.76, 0), vec3(0.16, 0.16, 0.13), 10, 6);
	mesh_ellipsoid(mesh, vec3(-0.42, 0.78, 0), vec3(0.17, 0.17, 0.14), 10, 6);
	/* A blanket with a fringe between the humps. */
	mesh_material(mesh, LAYER_FABRIC, 0.55);
	mesh_tint(mesh, 0xe04838);
	mesh->brush.id = 11;
	mesh_ellipsoid(mesh, vec3(0, 0.03, 0), vec3(0.34, 0.535, 0.475), 16, 10);
	mesh_tint(mesh, 0x3478a8);
	mesh_ellipsoid(mesh, vec3(0, 0.12, 0), vec3(0.20, 0.47, 0.47), 14, 10);
}

static void build_head(struct scene *scene, struct mesh *mesh)
{
	mesh_material(mesh, LAYER_FUR, 0.9);
	mesh_tint(mesh, 0xd8a468);
	stage_begin(scene, mesh, RANGE_NECK);
	mesh->brush.id = 12;
	mesh_limb(mesh, vec3(0, 0, 0), 0.25, vec3(0, 0.62, 0), 0.155, 12);
	stage_end(scene, mesh, RANGE_NECK);
	stage_begin(scene, mesh, RANGE_HEAD);
	mesh->brush.id = 14;
	mesh_limb(mesh, vec3(-0.05, 0, 0), 0.155, vec3(0.36, -0.07, 0), 0.105, 12);
	mesh_ellipsoid(mesh, vec3(0.42, -0.08, 0), vec3(0.13, 0.10, 0.10), 10, 8);
	mesh_tint(mesh, 0x9a6a3c);
	for (int s = -1; s <= 1; s += 2)
		mesh_limb(mesh, vec3(-0.06, 0.10, 0.11 * s), 0.05, vec3(-0.16, 0.24, 0.17 * s), 0.022, 8);
	mesh_ellipsoid(mesh, vec3(-0.06, 0.14, 0), vec3(0.10, 0.08, 0.08), 8, 6);
	mesh_material(mesh, LAYER_PLAIN, 1.0);
	mesh_tint(mesh, 0x20140c);
	for (int s = -1; s <= 1; s += 2)
		mesh_ellipsoid(mesh, vec3(0.14, 0.05, 0.115 * s), vec3(0.032, 0.032, 0.022), 8, 6);
	mesh_material(mesh, LAYER_FABRIC, 0.3);
	mesh_tint(mesh, 0xe04838);
	mesh->transform = mat4_multiply(mat4_translation(0.22, -0.045, 0), mat4_rotation_y(SCENE_PI / 2.0));
	mesh_torus(mesh, 0.128, 0.016, 0, 2.0 * SCENE_PI, 16, 6);
	mesh->transform = mat4_identity();
	stage_end(scene, mesh, RANGE_HEAD);
	stage_begin(scene, mesh, RANGE_JAW);
	mesh_material(mesh, LAYER_FUR, 0.9);
	mesh_tint(mesh, 0xc8945c);
	mesh->brush.id = 15;
	mesh_limb(mesh, vec3(0, 0, 0), 0.07, vec3(0.30, -0.05, 0), 0.06, 10);
	stage_end(scene, mesh, RANGE_JAW);
	stage_begin(scene, mesh, RANGE_TAIL);
	mesh->brush.id = 16;
	mesh_limb(mesh, vec3(0, 0, 0), 0.055, vec3(0, -0.55, 0), 0.03, 8);
	mesh_tint(mesh, 0x7a5230);
	mesh_ellipsoid(mesh, vec3(0, -0.64, 0), vec3(0.055, 0.13, 0.055), 8, 6);
	stage_end(scene, mesh, RANGE_TAIL);
}

static void build_leg(struct scene *scene, struct mesh *mesh)
{
	mesh_material(mesh, LAYER_FUR, 0.9);
	mesh_tint(mesh, 0xd8a468);
	stage_begin(scene, mesh, RANGE_THIGH);
	mesh_limb(mesh, vec3(0, 0.05, 0), 0.19, vec3(0, -thigh, 0), 0.095, 12);
	stage_end(scene, mesh, RANGE_THIGH);
	mesh_tint(mesh, 0xc8945c);
	stage_begin(scene, mesh, RANGE_SHIN);
	mesh_limb(mesh, vec3(0, 0, 0), 0.10, vec3(0, -shin, 0), 0.065, 12);
	stage_end(scene, mesh, RANGE_SHIN);
	mesh_tint(mesh, 0x8a5c34);
	stage_begin(scene, mesh, RANGE_FOOT);
	mesh_ellipsoid(mesh, vec3(0.05, -0.03, 0), vec3(0.16, 0.075, 0.115), 12, 6);
	stage_end(scene, mesh, RANGE_FOOT);
}

static void build_cell(struct scene *scene, struct mesh *mesh, uint32_t variant)
{
	stage_begin(scene, mesh, RANGE_ROCKS + variant);
	mesh_material(mesh, LAYER_SAND, 1.5);
	for (uint32_t k = 0; k < 5; k++) {
		uint32_t seed = scene_hash(variant * 16 + k + 300);
		double z = k < 3 ? -1.6 - 7.0 * scene_random(seed, 1) : 1.3 + 0.9 * scene_random(seed, 1);
		double r = (0.12 + 0.45 * scene_random(seed, 2) * scene_random(seed, 3)) * (z > 0 ? 0.5 : 1.4);
		mesh->brush.id = 20 + k;
		mesh->brush.open = 230;
		mesh_tint(mesh, k & 1 ? 0xb08064 : 0x98765e);
		mesh_ellipsoid(mesh, vec3(cell * (scene_random(seed, 4) - 0.5), r * 0.25, z),
					   vec3(r * 1.3, r * (0.6 + 0.4 * scene_random(seed, 5)), r), 9, 6);
	}
	/* Far dunes and a mesa. */
	mesh_tint(mesh, 0xf0d0a0);
	for (uint32_t k = 0; k < 2; k++) {
		uint32_t seed = scene_hash(variant * 16 + k + 700);
		double wide = 4.5 + 3.0 * scene_random(seed, 3);
		mesh->brush.id = 30 + k;
		mesh_ellipsoid(mesh,
					   vec3(cell * (scene_random(seed, 1) - 0.5), -0.5, -14.0 - 12.0 * k - 6.0 * scene_random(seed, 2)),
					   vec3(wide, 1.1 + 1.6 * scene_random(seed, 4) + 0.9 * k, wide * 0.6), 14, 8);
	}
	stage_end(scene, mesh, RANGE_ROCKS + variant);
	stage_begin(scene, mesh, RANGE_TUFTS + variant);
	mesh_material(mesh, LAYER_TUFT, 1.0);
	for (uint32_t k = 0; k < 6; k++) {
		uint32_t seed = scene_hash(variant * 16 + k + 500);
		double size = 0.35 + 0.4 * scene_random(seed, 1),
			   z = k < 4 ? -1.2 - 6.0 * scene_random(seed, 2) : 1.0 + scene_random(seed, 2);
		mesh->brush.id = 40 + k;
		mesh->brush.sway = 60;
		mesh->brush.sway_phase = (uint8_t)seed;
		mesh_tint(mesh, k & 1 ? 0xd0b870 : 0xb0b468);
		mesh_card(mesh, vec3(cell * (scene_random(seed, 3) - 0.5), size * 0.46, z), vec3(size * 1.3, 0, 0.1),
				  vec3(0, size, 0), vec3(0, 1, 0.4));
	}
	mesh->brush.sway = 0;
	stage_end(scene, mesh, RANGE_TUFTS + variant);
}

static void build(struct scene *scene, struct mesh *mesh)
{
	stage_begin(scene, mesh, RANGE_BODY);
	build_body(mesh);
	stage_end(scene, mesh, RANGE_BODY);
	build_head(scene, mesh);
	build_leg(scene, mesh);
	for (uint32_t variant = 0; variant < VARIANTS; variant++)
		build_cell(scene, mesh, variant);
	stage_begin(scene, mesh, RANGE_GROUND);
	mesh->brush.id = 1;
	mesh->brush.open = 255;
	mesh_material(mesh, LAYER_SAND, 3.0);
	mesh_tint(mesh, 0xf8dcb0);
	mesh_quad(mesh, vec3(-120, 0, 12), vec3(120, 0, 12), vec3(120, 0, -150), vec3(-120, 0, -150), vec3(0, 1, 0));
	stage_end(scene, mesh, RANGE_GROUND);
	scene->look = (struct stage_look){
		.sun_direction = vec3_normalize(vec3(0.50, 0.62, 0.60)),
		.sun_color = vec3(1.18, 0.98, 0.70),
		.sky_color = vec3(0.40, 0.46, 0.56),
		.bounce_color = vec3(0.40, 0.29, 0.18),
		.horizon = vec3(0.94, 0.80, 0.60),
		.zenith = vec3(0.20, 0.42, 0.72),
		.sun_glow = vec3(0.5, 0.3, 0.1),
		.clouds = vec3(1.0, 0.93, 0.82),
		.cloud_layer = LAYER_CLOUDS,
		.haze = vec3(0.92, 0.78, 0.58),
		.haze_distance = 55.0,
		.sway_size = vec3(0.12, 0.04, 0.0),
		.fov_y = 0.72,
		.near = 0.2,
		.far = 200.0,
	};
}

static void plan(const struct scene *scene, double time, struct stage_plan *out)
{
	out->cell = floor(walked(time) / cell);
	stage_draw(out, STAGE_SOLID, RANGE_BODY, PART_BODY, 0);
	stage_draw(out, STAGE_SOLID, RANGE_NECK, PART_NECK, 0);
	stage_draw(out, STAGE_SOLID, RANGE_NECK, PART_UPPER_NECK, 1);
	stage_draw(out, STAGE_SOLID, RANGE_HEAD, PART_HEAD, 0);
	stage_draw(out, STAGE_SOLID, RANGE_JAW, PART_JAW, 0);
	stage_draw(out, STAGE_SOLID, RANGE_TAIL, PART_TAIL, 0);
	for (uint32_t leg = 0; leg < 4; leg++) {
		for (uint32_t joint = 0; joint < 3; joint++)
			stage_draw(out, STAGE_SOLID, RANGE_THIGH + joint, PART_LEGS + leg * 3 + joint, 100 + leg * 3 + joint);
	}
	for (int pass = 0; pass < 2; pass++) {
		for (int i = 0; i < CELLS; i++) {
			int k = MIDDLE + ((i & 1) ? (i + 1) / 2 : -i / 2);
			uint32_t number = (uint32_t)(int64_t)fmod(out->cell + k, 65536.0) + 65536u;
			uint32_t variant = scene_hash(number) % VARIANTS;
			if (pass == 0)
				stage_draw(out, STAGE_SOLID, RANGE_ROCKS + variant, PART_CELLS + (uint32_t)k, number * 64);
			else if (i < 9)
				stage_draw(out, STAGE_CUTOUT, RANGE_TUFTS + variant, PART_CELLS + (uint32_t)k, number * 64);
		}
		if (pass == 0)
			stage_draw(out, STAGE_SOLID, RANGE_GROUND, STAGE_PARTS - 1, 0);
	}
}

/* The foot stands still on the ground while it carries, then swings forward (two-bone inverse kinematics). */
static void pose_leg(struct stage_pose *pose, struct vec3 hip, double phase, double bend, int leg)
{
	double x, lift = 0.0;
	if (phase < stance) {
		x = stride * (0.5 - phase / stance);
	} else {
		double s = (phase - stance) / (1.0 - stance);
		x = stride * (-0.5 + s - sin(2.0 * SCENE_PI * s) / (2.0 * SCENE_PI) * 0.6);
		lift = 0.26 * sin(SCENE_PI * s) * sin(SCENE_PI * s);
	}
	double dx = x, dy = ankle + lift - hip.y, distance = fmin(hypot(dx, dy), thigh + shin - 1e-4);
	double at_hip = acos((thigh * thigh + distance * distance - shin * shin) / (2.0 * thigh * distance));
	double at_knee = acos((thigh * thigh + shin * shin - distance * distance) / (2.0 * thigh * shin));
	double upper = atan2(dx, -dy) + bend * at_hip, lower = upper - bend * (SCENE_PI - at_knee);
	struct mat4 at = mat4_multiply(mat4_translation(hip.x, hip.y, hip.z), mat4_rotation_z(upper));
	struct mat4 knee = mat4_multiply(mat4_multiply(at, mat4_translation(0, -thigh, 0)), mat4_rotation_z(lower - upper));
	struct mat4 foot = mat4_multiply(knee, mat4_translation(0, -shin, 0));
	pose->parts[PART_LEGS + leg * 3] = at;
	pose->parts[PART_LEGS + leg * 3 + 1] = knee;
	pose->parts[PART_LEGS + leg * 3 + 2] = mat4_multiply(foot, mat4_rotation_z(-lower - 0.5 * lift));
}

static void pose_head(struct stage_pose *pose, double time)
{
	struct mat4 body = pose->parts[PART_BODY];
	double nod = 0.10 * scene_wave(time, period / 2.0, 0.1), look = 0.35 * scene_wave(time, 7.0, 0.0);
	struct mat4 neck =
		mat4_multiply(body, mat4_multiply(mat4_translation(0.88, 0.05, 0), mat4_rotation_z(-1.05 + nod)));
	struct mat4 upper =
		mat4_multiply(neck, mat4_multiply(mat4_translation(0, 0.58, 0), mat4_rotation_z(0.82 - nod * 0.7)));
	upper = mat4_multiply(upper, mat4_multiply(mat4_rotation_y(look * 0.5), mat4_scaling(0.72, 1.0, 0.72)));
	pose->parts[PART_NECK] = neck;
	pose->parts[PART_UPPER_NECK] = upper;
	struct mat4 head =
		mat4_multiply(upper, mat4_multiply(mat4_scaling(1.0 / 0.72, 1.0, 1.0 / 0.72), mat4_translation(0.02, 0.66, 0)));
	head = mat4_multiply(head, mat4_multiply(mat4_rotation_y(look * 0.5), mat4_rotation_z(0.12 - nod)));
	pose->parts[PART_HEAD] = head;
	double chew = 0.10 + 0.10 * scene_wave(time, 0.9, 0.0);
	pose->parts[PART_JAW] =
		mat4_multiply(head, mat4_multiply(mat4_translation(0.10, -0.11, 0), mat4_rotation_z(-chew)));
}

static void pose(const struct scene *scene, double time, const struct stage_plan *out, struct stage_pose *pose)
{
	static const double phases[4] = {0.25, 0.75, 0.0, 0.5}; /* fore left, fore right, hind left, hind right */
	double x = walked(time) - out->cell * cell, gait = scene_phase(time, period);
	double bob = 0.035 * scene_wave(time, period / 2.0, 0.0), pitch = 0.03 * scene_wave(time, period / 2.0, 0.25);
	pose->parts[PART_BODY] = mat4_multiply(mat4_translation(x, 2.02 + bob, 0), mat4_rotation_z(pitch));
	pose_head(pose, time);
	pose->parts[PART_TAIL] = mat4_multiply(
		pose->parts[PART_BODY],
		mat4_multiply(mat4_translation(-1.02, 0.12, 0),
					  mat4_multiply(mat4_rotation_x(0.5 * scene_wave(time, 1.7, 0.0)), mat4_rotation_z(-0.25))));
	for (int leg = 0; leg < 4; leg++) {
		double phase = fmod(gait + phases[leg], 1.0), side = leg & 1 ? 0.24 : -0.24;
		struct vec3 hip = vec3(leg < 2 ? 0.64 : -0.70, 1.72 + bob, side);
		pose_leg(pose, hip, phase, leg < 2 ? 1.0 : -1.0, leg);
		for (int joint = 0; joint < 3; joint++)
			pose->parts[PART_LEGS + leg * 3 + joint].m[12] += x;
	}
	for (int k = 0; k < CELLS; k++)
		pose->parts[PART_CELLS + k] = mat4_translation(cell * (k - MIDDLE), 0, 0);
	double angle = 0.45 * scene_wave(time, 21.0, 0.08), distance = 5.6 + 0.7 * scene_wave(time, 17.0, 0.0);
	struct vec3 eye =
		vec3(x + 0.3 + distance * sin(angle), 1.9 + 0.4 * scene_wave(time, 13.0, 0.3), distance * cos(angle));
	pose->view = mat4_look_at(eye, vec3(x + 0.35, 1.62, 0));
	pose->sway[0] = 2.0 * SCENE_PI * scene_phase(time, 2.1);
	pose->sway[1] = 2.0 * SCENE_PI * scene_phase(time, 1.3);
}

const struct stage_kind scene_creature = {
	.name = "creature",
	.description = "a walking animal: heterogeneous motion",
	.materials = {MATERIAL_FUR, MATERIAL_SAND, MATERIAL_FABRIC, MATERIAL_PLAIN, MATERIAL_TUFT, MATERIAL_CLOUDS},
	.material_count = 6,
	.build = build,
	.plan = plan,
	.pose = pose,
};
