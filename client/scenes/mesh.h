/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Builds the triangles of a scene from simple shapes, with a brush that says
 * how they look. Lengths in metres. Triangles turn themselves so that their
 * front is where the normals point. Textures follow the surface: flat shapes
 * are mapped by their position, so neighbours continue each other.
 */
#ifndef PURSUIT_SCENES_MESH_H
#define PURSUIT_SCENES_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "maths.h"

struct mesh_vertex {
	float position[3];
	int8_t normal[4];
	float uv[2];
	uint8_t tint[4];  /* rgb, and how much of the sky is seen */
	uint8_t extra[4]; /* texture layer, sway weight, sway phase, own light */
	uint32_t id;
};

struct mesh_brush {
	uint8_t layer; /* of the scene's material array */
	double repeat; /* metres per repeat of the texture */
	uint8_t tint[3];
	uint8_t open; /* 255: sees the whole sky; 0: no ambient light */
	uint8_t sway, sway_phase;
	uint8_t glow; /* own light, 64 is 1 */
	uint32_t id;
};

struct mesh {
	struct mesh_vertex *vertices;
	uint32_t *indices;
	size_t vertex_count, vertex_capacity, index_count, index_capacity;
	struct mat4 transform; /* rigid or uniformly scaled */
	struct mesh_brush brush;
	bool failed; /* out of memory */
};

void mesh_init(struct mesh *mesh);
void mesh_finish(struct mesh *mesh);

void mesh_material(struct mesh *mesh, uint8_t layer, double repeat);
void mesh_tint(struct mesh *mesh, uint32_t rgb);

uint32_t mesh_add_vertex(struct mesh *mesh, struct vec3 position, struct vec3 normal, double u, double v);
void mesh_add_triangle(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c);

/* Four corners in order around; mapped by position along the two axes that `normal` is least along. */
void mesh_quad(struct mesh *mesh, struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 d, struct vec3 normal);

enum mesh_faces {
	MESH_LEFT = 1,
	MESH_RIGHT = 2,
	MESH_BOTTOM = 4,
	MESH_TOP = 8,
	MESH_BACK = 16,
	MESH_FRONT = 32,
	MESH_ALL = 63,
};
void mesh_box(struct mesh *mesh, struct vec3 low, struct vec3 high, uint32_t faces);

/* A square bar from a to b, texture along it, no ends. */
void mesh_beam(struct mesh *mesh, struct vec3 a, struct vec3 b, double width, double depth);

/* Around the y axis at `base`; profile of radius and height pairs, upwards. u goes `turns` repeats around. */
void mesh_lathe(struct mesh *mesh, struct vec3 base, const double (*profile)[2], size_t count, int segments,
				double turns);
void mesh_ellipsoid(struct mesh *mesh, struct vec3 center, struct vec3 radii, int segments, int rings);

/* A tapered limb with round ends. */
void mesh_limb(struct mesh *mesh, struct vec3 a, double radius_a, struct vec3 b, double radius_b, int segments);

/* Part of a ring in the xy plane, from angle `from` to `to`, with flat ends. */
void mesh_torus(struct mesh *mesh, double radius, double thickness, double from, double to, int segments, int sides);

/* A flat picture, seen from both sides, uv 0 to 1; `right` and `up` are its full edges. The sway acts on its top. */
void mesh_card(struct mesh *mesh, struct vec3 center, struct vec3 right, struct vec3 up, struct vec3 normal);

#endif
