/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What a scene is made of, for the files of this folder. A kind builds its
 * triangles once; then, for any moment, it plans which ranges to draw (near
 * to far) and poses camera and parts. The renderer poses the same plan at two
 * moments, so motion is exact whatever moves. Endless scenes place their plan
 * around where the camera is at the time of the plan.
 */
#ifndef PURSUIT_SCENES_STAGE_H
#define PURSUIT_SCENES_STAGE_H

#include "gl.h"
#include "materials.h"
#include "maths.h"
#include "mesh.h"
#include "overlay.h"
#include "scene.h"

#define STAGE_RANGES 64
#define STAGE_PARTS 96
#define STAGE_DRAWS 128
#define STAGE_MATERIALS 8
#define STAGE_ATTACHMENTS 5

enum stage_program { STAGE_SOLID, STAGE_CUTOUT, STAGE_COLONNADE, STAGE_SKY, STAGE_OVERLAY, STAGE_PROGRAMS };

struct stage_range {
	uint32_t first, count; /* indices */
};

struct stage_draw {
	enum stage_program program;
	uint32_t range;
	uint32_t part;
	uint32_t id_base;
	bool tinted;
	float tint[4]; /* if tinted: rgb, own light */
};

struct stage_plan {
	double time;
	struct vec3 origin; /* what the kind subtracts from all positions of an endless world */
	double cell;        /* the first cell of an endless world */
	uint32_t draw_count;
	struct stage_draw draws[STAGE_DRAWS];
};

struct stage_pose {
	struct mat4 view;
	struct mat4 parts[STAGE_PARTS];
	double sway[2]; /* radians */
};

/* Light, sky, haze and lens; set by build. Colours are linear light. */
struct stage_look {
	struct vec3 sun_direction, sun_color, sky_color, bounce_color;
	struct vec3 horizon, zenith, sun_glow, clouds;
	int cloud_layer; /* negative: none */
	struct vec3 haze;
	double haze_distance; /* where the haze is half */
	struct vec3 sway_size;
	double fov_y; /* radians */
	double near, far;
};

struct stage_kind {
	const char *name;
	const char *description;
	enum material materials[STAGE_MATERIALS];
	uint32_t material_count;
	/* Fills mesh, ranges and look. */
	void (*build)(struct scene *scene, struct mesh *mesh);
	void (*plan)(const struct scene *scene, double time, struct stage_plan *plan);
	void (*pose)(const struct scene *scene, double time, const struct stage_plan *plan, struct stage_pose *pose);
	/* NULL: no UI layer. */
	void (*overlay)(const struct scene *scene, double time, struct overlay *overlay);
	/* NULL: no task. */
	void (*key)(struct scene *scene, double time, int key);
	void (*score)(const struct scene *scene, double time, struct scene_score *score);
};

/* Answers of the task scene, by ring, in the order of their numbers. */
struct stage_answer {
	uint64_t ring;
	bool right;
};

struct scene {
	const struct stage_kind *kind;
	uint32_t width, height;
	struct scene_gl gl;
	struct stage_look look;
	struct stage_range ranges[STAGE_RANGES];
	struct stage_plan plan;
	struct stage_pose now, other;
	struct overlay overlay;
	struct stage_answer *answers;
	size_t answer_count, answer_capacity;

	GLuint programs[STAGE_PROGRAMS];
	GLuint vertex_array, vertex_buffer, index_buffer, materials;
	GLuint overlay_array, overlay_buffer, glyphs;
	GLuint targets[STAGE_ATTACHMENTS]; /* colour, depth, backward, id, forward */
	GLuint ui;
	GLuint depth_buffer;
	GLuint frame, forward_frame, ui_frame;
	bool has_targets, has_forward, ui_drawn;
	bool drawn; /* the targets hold `drawn_now` against `drawn_previous` */
	struct stage_plan drawn_plan;
	struct stage_pose drawn_now, drawn_previous;
	uint64_t ui_hash;
};

extern const struct stage_kind scene_colonnade, scene_tower, scene_fan, scene_trees, scene_creature, scene_rings,
	scene_hud, scene_still;

/* From here on triangles belong to `range`, which lasts until stage_end. */
void stage_begin(struct scene *scene, const struct mesh *mesh, uint32_t range);
void stage_end(struct scene *scene, const struct mesh *mesh, uint32_t range);

/* Appends a draw; ignored when the plan is full. */
struct stage_draw *stage_draw(struct stage_plan *plan, enum stage_program program, uint32_t range, uint32_t part,
							  uint32_t id_base);

/* programs.c */
bool stage_create_programs(struct scene *scene, char *error, size_t error_size);

/* buffers.c: triangles, materials and glyphs go to GL. */
bool stage_create_buffers(struct scene *scene, const struct mesh *mesh, char *error, size_t error_size);
void stage_destroy_buffers(struct scene *scene);

/* targets.c */
bool stage_create_targets(struct scene *scene, char *error, size_t error_size);
bool stage_create_forward(struct scene *scene);
void stage_destroy_targets(struct scene *scene);

/* draw.c: draws the plan with the poses `now` and `other` into the bound frame. */
struct mat4 stage_projection(const struct scene *scene);
void stage_draw_plan(const struct scene *scene, double motion_sign);
void stage_draw_overlay(struct scene *scene);

#endif
