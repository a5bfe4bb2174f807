/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The task (Didyk et al. 2010, Section 7.2): three-dimensional Landolt rings
 * cross the picture one after the other, open or closed by a seeded hash of
 * their number. Ring k is in sight from its start to its end and answered by
 * the first key in that time; keys with no ring in sight are ignored.
 */
#include <stdio.h>
#include <stdlib.h>

#include "stage.h"

enum { LAYER_PLAIN, LAYER_GRID, LAYER_PAINT, LAYER_CLOUDS };
enum { RANGE_OPEN, RANGE_CLOSED, RANGE_GROUND, RANGE_PYLON };
enum { PART_RING, PART_CELLS, CELLS = 12 };
enum { SEED = 20100501 };

static const double cell = 8.0, radius = 0.62, thickness = 0.17, interval = 1.7;

struct flight {
	uint64_t ring;
	double start, end;
	bool open, leftward;
	double depth, height, roll, spin;
	uint32_t color;
};

/* The flight whose slot a time is in; slots are `interval` long and each holds one whole flight. */
static struct flight flight_of(uint64_t ring)
{
	uint32_t id = (uint32_t)ring ^ (uint32_t)(ring >> 32);
	struct flight flight = {.ring = ring};
	flight.start = (double)ring * interval + 0.15 + 0.25 * scene_random(id, SEED + 1);
	flight.end = flight.start + 0.95 + 0.30 * scene_random(id, SEED + 2);
	flight.open = scene_hash2(id, SEED + 3) & 1;
	flight.leftward = scene_hash2(id, SEED + 4) & 1;
	flight.depth = 4.2 + 2.0 * scene_random(id, SEED + 5);
	flight.height = 0.9 * (scene_random(id, SEED + 6) - 0.45);
	flight.roll = 2.0 * SCENE_PI * scene_random(id, SEED + 7);
	flight.spin = 3.0 * (scene_random(id, SEED + 8) - 0.5);
	flight.color = scene_hash2(id, SEED + 9) % 5;
	return flight;
}

/* Beyond this the double has no fraction left to tell rings apart. */
static const double last_time = 1e12;

static bool flight_at(double time, struct flight *flight)
{
	if (time < 0.0 || time > last_time)
		return false;
	*flight = flight_of((uint64_t)floor(time / interval));
	return true;
}

static bool in_sight(const struct flight *flight, double time)
{
	return time >= flight->start && time < flight->end;
}

static void build_ring(struct scene *scene, struct mesh *mesh, uint32_t range, double gap)
{
	stage_begin(scene, mesh, range);
	mesh_material(mesh, LAYER_PAINT, 0.5);
	mesh_torus(mesh, radius, thickness, gap * 0.5, 2.0 * SCENE_PI - gap * 0.5, 44, 12);
	stage_end(scene, mesh, range);
}

static void build(struct scene *scene, struct mesh *mesh)
{
	mesh->brush.id = 100;
	build_ring(scene, mesh, RANGE_OPEN, 0.62);
	build_ring(scene, mesh, RANGE_CLOSED, 0.0);
	stage_begin(scene, mesh, RANGE_GROUND);
	mesh->brush.id = 1;
	mesh_material(mesh, LAYER_GRID, 8.0);
	mesh_tint(mesh, 0x6878a0);
	mesh_quad(mesh, vec3(-80, 0, 16), vec3(80, 0, 16), vec3(80, 0, -160), vec3(-80, 0, -160), vec3(0, 1, 0));
	stage_end(scene, mesh, RANGE_GROUND);
	stage_begin(scene, mesh, RANGE_PYLON);
	for (int s = -1; s <= 1; s += 2) {
		mesh->brush.id = (uint32_t)(10 + s);
		mesh->brush.glow = 0;
		mesh_material(mesh, LAYER_GRID, 3.0);
		mesh_tint(mesh, 0x8890b8);
		mesh_box(mesh, vec3(8.6 * s - 0.7, 0, -0.7), vec3(8.6 * s + 0.7, 3.4, 0.7), MESH_ALL & ~MESH_BOTTOM);
		mesh_box(mesh, vec3(14.0 * s - 1.8, 0, -2.6), vec3(14.0 * s + 1.8, 7.5, 0.4), MESH_ALL & ~MESH_BOTTOM);
		mesh_material(mesh, LAYER_PLAIN, 1.0);
		mesh->brush.glow = 30;
		mesh_tint(mesh, s < 0 ? 0x50d8f0 : 0xf07850);
		mesh_box(mesh, vec3(8.6 * s - 0.8, 3.4, -0.8), vec3(8.6 * s + 0.8, 3.65, 0.8), MESH_ALL);
		mesh->brush.glow = 0;
	}
	stage_end(scene, mesh, RANGE_PYLON);
	scene->look = (struct stage_look){
		.sun_direction = vec3_normalize(vec3(0.35, 0.60, 0.72)),
		.sun_color = vec3(0.95, 0.80, 0.66),
		.sky_color = vec3(0.36, 0.38, 0.52),
		.bounce_color = vec3(0.20, 0.16, 0.22),
		.horizon = vec3(0.86, 0.56, 0.42),
		.zenith = vec3(0.08, 0.12, 0.34),
		.sun_glow = vec3(0.2, 0.1, 0.1),
		.clouds = vec3(0.88, 0.58, 0.52),
		.cloud_layer = LAYER_CLOUDS,
		.haze = vec3(0.72, 0.48, 0.42),
		.haze_distance = 60.0,
		.fov_y = 0.90,
		.near = 0.2,
		.far = 220.0,
	};
}

static double flown(double time)
{
	return 5.0 * time;
}

static void plan(const struct scene *scene, double time, struct stage_plan *out)
{
	static const float colors[5][4] = {{0.96f, 0.78f, 0.24f, 0},
									   {0.30f, 0.80f, 0.86f, 0},
									   {0.95f, 0.42f, 0.34f, 0},
									   {0.55f, 0.86f, 0.42f, 0},
									   {0.86f, 0.60f, 0.95f, 0}};
	struct flight flight;
	out->cell = floor(flown(time) / cell);
	if (flight_at(time, &flight) && in_sight(&flight, time)) {
		struct stage_draw *draw = stage_draw(out, STAGE_SOLID, flight.open ? RANGE_OPEN : RANGE_CLOSED, PART_RING,
											 (uint32_t)(flight.ring % 1000000u) * 16u);
		draw->tinted = true;
		for (int c = 0; c < 4; c++)
			draw->tint[c] = colors[flight.color][c];
		draw->tint[3] = 0.08f;
	}
	for (int k = 0; k < CELLS; k++) {
		uint32_t number = (uint32_t)(int64_t)fmod(out->cell + k, 65536.0) + 65536u;
		stage_draw(out, STAGE_SOLID, RANGE_PYLON, (uint32_t)(PART_CELLS + k), number * 256 + 0x40000000u);
	}
	stage_draw(out, STAGE_SOLID, RANGE_GROUND, STAGE_PARTS - 1, 0);
}

/* From just outside one border to just outside the other, on a shallow arc, in the camera's space. */
static struct mat4 ring_in_view(const struct scene *scene, const struct flight *flight, double time)
{
	double aspect = (double)scene->width / (double)scene->height,
		   s = (time - flight->start) / (flight->end - flight->start);
	double edge = tan(scene->look.fov_y * 0.5) * aspect * flight->depth + (radius + thickness) * 1.25;
	double x = edge * (2.0 * s - 1.0) * (flight->leftward ? -1.0 : 1.0);
	double z = -flight->depth - 1.2 * sin(SCENE_PI * s), y = flight->height + 0.35 * sin(SCENE_PI * s);
	struct mat4 place = mat4_multiply(mat4_translation(x, y, z), mat4_rotation_y(0.55 * (2.0 * s - 1.0)));
	return mat4_multiply(place, mat4_rotation_z(flight->roll + flight->spin * s));
}

static void pose(const struct scene *scene, double time, const struct stage_plan *out, struct stage_pose *pose)
{
	struct vec3 eye = vec3(0.8 * scene_wave(time, 9.0, 0.0), 2.1 + 0.2 * scene_wave(time, 7.0, 0.2),
						   -(flown(time) - out->cell * cell));
	double yaw = 0.06 * scene_wave(time, 11.0, 0.0);
	struct flight flight;
	pose->view = mat4_look_at(eye, vec3_add(eye, vec3(sin(yaw), 0.02, -cos(yaw))));
	/* The ring of the moment that is drawn, also where the other moment lies before or after its flight. */
	if (flight_at(out->time, &flight)) {
		struct mat4 camera = mat4_rigid_inverse(&pose->view);
		pose->parts[PART_RING] = mat4_multiply(camera, ring_in_view(scene, &flight, time));
	}
	for (int k = 0; k < CELLS; k++)
		pose->parts[PART_CELLS + k] = mat4_translation(0, 0, -cell * (k - 0.3));
}

static struct stage_answer *find_answer(const struct scene *scene, uint64_t ring)
{
	for (size_t i = scene->answer_count; i > 0; i--) {
		if (scene->answers[i - 1].ring == ring)
			return &scene->answers[i - 1];
	}
	return NULL;
}

static void key(struct scene *scene, double time, int key)
{
	struct flight flight;
	if ((key != 'o' && key != 'c') || !flight_at(time, &flight) || !in_sight(&flight, time) ||
		find_answer(scene, flight.ring))
		return;
	if (scene->answer_count == scene->answer_capacity) {
		size_t wanted = scene->answer_capacity ? scene->answer_capacity * 2 : 64;
		struct stage_answer *bigger = realloc(scene->answers, wanted * sizeof(*bigger));
		if (!bigger)
			return;
		scene->answers = bigger;
		scene->answer_capacity = wanted;
	}
	scene->answers[scene->answer_count++] = (struct stage_answer){flight.ring, flight.open == (key == 'o')};
}

static void score(const struct scene *scene, double time, struct scene_score *out)
{
	if (time < 0.0)
		return;
	uint64_t begun = (uint64_t)floor(fmin(time, last_time) / interval), answered = 0;
	struct flight flight = flight_of(begun);
	uint64_t shown = begun + (time >= flight.end ? 1 : 0);
	for (size_t i = 0; i < scene->answer_count; i++) {
		const struct stage_answer *answer = &scene->answers[i];
		if (answer->ring > begun)
			continue;
		out->hits += answer->right;
		out->false_answers += !answer->right;
		answered += answer->ring < shown;
	}
	out->shown = (uint32_t)(shown > UINT32_MAX ? UINT32_MAX : shown);
	out->misses = (uint32_t)(shown - answered > UINT32_MAX ? UINT32_MAX : shown - answered);
}

static void overlay(const struct scene *scene, double time, struct overlay *ui)
{
	struct scene_score now = {0};
	char text[64];
	double unit = ui->unit, line = 11.0 * unit, width = 78.0 * unit;
	score(scene, time, &now);
	overlay_rectangle(ui, 4 * unit, 4 * unit, width, 5 * line, 0x101828, 0.62);
	overlay_frame(ui, 4 * unit, 4 * unit, width, 5 * line, unit, 0x60d0f0, 0.9);
	const struct {
		const char *name;
		uint32_t value, color;
	} rows[4] = {{"RINGS", now.shown, 0xe8f0ff},
				 {"HITS", now.hits, 0x80f090},
				 {"MISSES", now.misses, 0xf0d070},
				 {"FALSE", now.false_answers, 0xf08070}};
	for (int i = 0; i < 4; i++) {
		snprintf(text, sizeof(text), "%-7s%4u", rows[i].name, rows[i].value % 10000u);
		overlay_text(ui, 9 * unit, (10 + 11 * i) * unit, 1.0, rows[i].color, text);
	}
	const char *help = "O OPEN   C CLOSED";
	double help_width = 17 * 6 * unit, x = floor((ui->width - help_width) * 0.5), y = ui->height - 16 * unit;
	overlay_rectangle(ui, x - 5 * unit, y - 4 * unit, help_width + 9 * unit, 15 * unit, 0x101828, 0.55);
	overlay_text(ui, x, y, 1.0, 0xffffff, help);
	double cx = floor(ui->width * 0.5), cy = floor(ui->height * 0.5);
	overlay_rectangle(ui, cx - 5 * unit, cy, 10 * unit + unit, unit, 0xffffff, 0.7);
	overlay_rectangle(ui, cx, cy - 5 * unit, unit, 10 * unit + unit, 0xffffff, 0.7);
}

const struct stage_kind scene_rings = {
	.name = "rings",
	.description = "the task: open and closed rings fly by; keys o and c",
	.materials = {MATERIAL_PLAIN, MATERIAL_GRID, MATERIAL_PAINT, MATERIAL_CLOUDS},
	.material_count = 4,
	.build = build,
	.plan = plan,
	.pose = pose,
	.overlay = overlay,
	.key = key,
	.score = score,
};
