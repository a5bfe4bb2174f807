/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "mesh.h"

#include <stdlib.h>

void mesh_init(struct mesh *mesh)
{
	*mesh = (struct mesh){.transform = mat4_identity()};
	mesh->brush = (struct mesh_brush){.repeat = 1.0, .tint = {255, 255, 255}, .open = 255, .id = 1};
}

void mesh_finish(struct mesh *mesh)
{
	free(mesh->vertices);
	free(mesh->indices);
	*mesh = (struct mesh){0};
}

void mesh_material(struct mesh *mesh, uint8_t layer, double repeat)
{
	mesh->brush.layer = layer;
	mesh->brush.repeat = repeat;
}

void mesh_tint(struct mesh *mesh, uint32_t rgb)
{
	mesh->brush.tint[0] = (uint8_t)(rgb >> 16);
	mesh->brush.tint[1] = (uint8_t)(rgb >> 8);
	mesh->brush.tint[2] = (uint8_t)rgb;
}

static bool grow(void **array, size_t *capacity, size_t count, size_t item)
{
	if (count < *capacity)
		return true;
	size_t wanted = *capacity ? *capacity * 2 : 1024;
	void *bigger = realloc(*array, wanted * item);
	if (!bigger)
		return false;
	*array = bigger;
	*capacity = wanted;
	return true;
}

static int8_t normal_byte(double x)
{
	return (int8_t)lrint(fmax(-127.0, fmin(127.0, x * 127.0)));
}

uint32_t mesh_add_vertex(struct mesh *mesh, struct vec3 position, struct vec3 normal, double u, double v)
{
	if (mesh->failed ||
		!grow((void **)&mesh->vertices, &mesh->vertex_capacity, mesh->vertex_count, sizeof(*mesh->vertices))) {
		mesh->failed = true;
		return 0;
	}
	const struct mesh_brush *brush = &mesh->brush;
	struct vec3 p = mat4_point(&mesh->transform, position);
	struct vec3 n = vec3_normalize(mat4_direction(&mesh->transform, normal));
	mesh->vertices[mesh->vertex_count] = (struct mesh_vertex){
		.position = {(float)p.x, (float)p.y, (float)p.z},
		.normal = {normal_byte(n.x), normal_byte(n.y), normal_byte(n.z), 0},
		.uv = {(float)u, (float)v},
		.tint = {brush->tint[0], brush->tint[1], brush->tint[2], brush->open},
		.extra = {brush->layer, brush->sway, brush->sway_phase, brush->glow},
		.id = brush->id,
	};
	return (uint32_t)mesh->vertex_count++;
}

static struct vec3 position_of(const struct mesh *mesh, uint32_t i)
{
	const float *p = mesh->vertices[i].position;
	return vec3((double)p[0], (double)p[1], (double)p[2]);
}

static struct vec3 normal_of(const struct mesh *mesh, uint32_t i)
{
	const int8_t *n = mesh->vertices[i].normal;
	return vec3(n[0], n[1], n[2]);
}

void mesh_add_triangle(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
	if (mesh->failed ||
		!grow((void **)&mesh->indices, &mesh->index_capacity, mesh->index_count + 2, sizeof(*mesh->indices))) {
		mesh->failed = true;
		return;
	}
	struct vec3 p = position_of(mesh, a);
	struct vec3 face = vec3_cross(vec3_sub(position_of(mesh, b), p), vec3_sub(position_of(mesh, c), p));
	struct vec3 normal = vec3_add(normal_of(mesh, a), vec3_add(normal_of(mesh, b), normal_of(mesh, c)));
	if (vec3_length(face) < 1e-12)
		return;
	bool turned = vec3_dot(face, normal) < 0.0;
	mesh->indices[mesh->index_count++] = a;
	mesh->indices[mesh->index_count++] = turned ? c : b;
	mesh->indices[mesh->index_count++] = turned ? b : c;
}

static void add_quad(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
	mesh_add_triangle(mesh, a, b, c);
	mesh_add_triangle(mesh, a, c, d);
}

static uint32_t flat_vertex(struct mesh *mesh, struct vec3 p, struct vec3 normal)
{
	struct vec3 n = vec3(fabs(normal.x), fabs(normal.y), fabs(normal.z));
	double u = p.x, v = p.y;
	if (n.y >= n.x && n.y >= n.z) {
		v = p.z;
	} else if (n.x >= n.z) {
		u = p.z;
	}
	return mesh_add_vertex(mesh, p, normal, u / mesh->brush.repeat, v / mesh->brush.repeat);
}

void mesh_quad(struct mesh *mesh, struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 d, struct vec3 normal)
{
	uint32_t i[4] = {flat_vertex(mesh, a, normal), flat_vertex(mesh, b, normal), flat_vertex(mesh, c, normal),
					 flat_vertex(mesh, d, normal)};
	add_quad(mesh, i[0], i[1], i[2], i[3]);
}

void mesh_box(struct mesh *mesh, struct vec3 low, struct vec3 high, uint32_t faces)
{
	struct vec3 p[8];
	for (int i = 0; i < 8; i++)
		p[i] = vec3(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
	if (faces & MESH_LEFT)
		mesh_quad(mesh, p[0], p[4], p[6], p[2], vec3(-1, 0, 0));
	if (faces & MESH_RIGHT)
		mesh_quad(mesh, p[1], p[3], p[7], p[5], vec3(1, 0, 0));
	if (faces & MESH_BOTTOM)
		mesh_quad(mesh, p[0], p[1], p[5], p[4], vec3(0, -1, 0));
	if (faces & MESH_TOP)
		mesh_quad(mesh, p[2], p[6], p[7], p[3], vec3(0, 1, 0));
	if (faces & MESH_BACK)
		mesh_quad(mesh, p[0], p[2], p[3], p[1], vec3(0, 0, -1));
	if (faces & MESH_FRONT)
		mesh_quad(mesh, p[4], p[5], p[7], p[6], vec3(0, 0, 1));
}

void mesh_beam(struct mesh *mesh, struct vec3 a, struct vec3 b, double width, double depth)
{
	struct mat4 frame = mat4_along(a, vec3_sub(b, a));
	double length = vec3_length(vec3_sub(b, a)), x = width * 0.5, y = depth * 0.5;
	const double corners[5][2] = {{-x, -y}, {x, -y}, {x, y}, {-x, y}, {-x, -y}};
	const struct vec3 normals[4] = {{0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
	for (int i = 0; i < 4; i++) {
		struct vec3 n = mat4_direction(&frame, normals[i]);
		uint32_t v[4];
		for (int k = 0; k < 4; k++) {
			int side = (k == 1 || k == 2), end = k >= 2;
			struct vec3 p = vec3(corners[i + side][0], corners[i + side][1], end ? length : 0.0);
			v[k] = mesh_add_vertex(mesh, mat4_point(&frame, p), n, side, end ? length / mesh->brush.repeat : 0.0);
		}
		add_quad(mesh, v[0], v[1], v[2], v[3]);
	}
}

void mesh_lathe(struct mesh *mesh, struct vec3 base, const double (*profile)[2], size_t count, int segments,
				double turns)
{
	double v = 0.0;
	for (size_t i = 0; i + 1 < count; i++) {
		double dr = profile[i + 1][0] - profile[i][0], dy = profile[i + 1][1] - profile[i][1];
		double next_v = v + hypot(dr, dy) / mesh->brush.repeat;
		uint32_t before[2] = {0, 0};
		for (int s = 0; s <= segments && hypot(dr, dy) > 1e-9; s++) {
			double angle = 2.0 * SCENE_PI * s / segments, c = cos(angle), n = sin(angle);
			struct vec3 normal = vec3(c * dy, -dr, n * dy);
			uint32_t now[2];
			for (size_t k = 0; k < 2; k++) {
				double r = profile[i + k][0];
				now[k] = mesh_add_vertex(mesh, vec3(base.x + r * c, base.y + profile[i + k][1], base.z + r * n), normal,
										 turns * s / segments, k ? next_v : v);
			}
			if (s > 0)
				add_quad(mesh, before[0], now[0], now[1], before[1]);
			before[0] = now[0];
			before[1] = now[1];
		}
		v = next_v;
	}
}

void mesh_ellipsoid(struct mesh *mesh, struct vec3 center, struct vec3 radii, int segments, int rings)
{
	double around = 2.0 * SCENE_PI * fmax(radii.x, radii.z) / mesh->brush.repeat;
	double turns = fmax(1.0, floor(around + 0.5));
	uint32_t stride = (uint32_t)segments + 1, first = (uint32_t)mesh->vertex_count;
	for (int i = 0; i <= rings; i++) {
		double down = SCENE_PI * i / rings;
		for (int s = 0; s <= segments; s++) {
			double angle = 2.0 * SCENE_PI * s / segments;
			struct vec3 d = vec3(sin(down) * cos(angle), cos(down), sin(down) * sin(angle));
			mesh_add_vertex(mesh, vec3(center.x + d.x * radii.x, center.y + d.y * radii.y, center.z + d.z * radii.z),
							vec3(d.x / radii.x, d.y / radii.y, d.z / radii.z), turns * s / segments,
							radii.y * down / mesh->brush.repeat);
		}
	}
	for (uint32_t i = 0; i < (uint32_t)rings && !mesh->failed; i++) {
		for (uint32_t s = 0; s < (uint32_t)segments; s++) {
			uint32_t a = first + i * stride + s;
			add_quad(mesh, a, a + 1, a + stride + 1, a + stride);
		}
	}
}

void mesh_limb(struct mesh *mesh, struct vec3 a, double radius_a, struct vec3 b, double radius_b, int segments)
{
	struct mat4 frame = mat4_along(a, vec3_sub(b, a));
	double length = vec3_length(vec3_sub(b, a));
	const double rows[6][3] = {/* angle of the normal, centre (0: a, 1: b), unused */
							   {-0.5, 0, 0}, {-0.25, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0.25, 1, 0}, {0.5, 1, 0}};
	double turns = fmax(1.0, floor(2.0 * SCENE_PI * fmax(radius_a, radius_b) / mesh->brush.repeat + 0.5));
	uint32_t stride = (uint32_t)segments + 1, first = (uint32_t)mesh->vertex_count;
	for (int i = 0; i < 6; i++) {
		double tilt = rows[i][0] * SCENE_PI, radius = rows[i][1] > 0 ? radius_b : radius_a;
		double z = rows[i][1] * length + sin(tilt) * radius, r = cos(tilt) * radius;
		for (int s = 0; s <= segments; s++) {
			double angle = 2.0 * SCENE_PI * s / segments;
			struct vec3 n = vec3(cos(tilt) * cos(angle), cos(tilt) * sin(angle), sin(tilt));
			mesh_add_vertex(mesh, mat4_point(&frame, vec3(r * cos(angle), r * sin(angle), z)),
							mat4_direction(&frame, n), turns * s / segments, z / mesh->brush.repeat);
		}
	}
	for (uint32_t i = 0; i < 5 && !mesh->failed; i++) {
		for (uint32_t s = 0; s < (uint32_t)segments; s++) {
			uint32_t v = first + i * stride + s;
			add_quad(mesh, v, v + 1, v + stride + 1, v + stride);
		}
	}
}

static void torus_end(struct mesh *mesh, double radius, double thickness, double angle, double facing, int sides)
{
	struct vec3 out = vec3(cos(angle), sin(angle), 0), normal = vec3(-sin(angle) * facing, cos(angle) * facing, 0);
	uint32_t center = mesh_add_vertex(mesh, vec3_scale(out, radius), normal, 0.5, 0.5), before = 0;
	for (int k = 0; k <= sides; k++) {
		double side = 2.0 * SCENE_PI * k / sides;
		struct vec3 p = vec3_scale(out, radius + thickness * cos(side));
		p.z = thickness * sin(side);
		uint32_t now = mesh_add_vertex(mesh, p, normal, 0.5 + 0.5 * cos(side), 0.5 + 0.5 * sin(side));
		if (k > 0)
			mesh_add_triangle(mesh, center, before, now);
		before = now;
	}
}

void mesh_torus(struct mesh *mesh, double radius, double thickness, double from, double to, int segments, int sides)
{
	uint32_t stride = (uint32_t)sides + 1, first = (uint32_t)mesh->vertex_count;
	for (int s = 0; s <= segments; s++) {
		double angle = from + (to - from) * s / segments;
		struct vec3 out = vec3(cos(angle), sin(angle), 0);
		for (int k = 0; k <= sides; k++) {
			double side = 2.0 * SCENE_PI * k / sides;
			struct vec3 n = vec3(out.x * cos(side), out.y * cos(side), sin(side));
			struct vec3 p = vec3_add(vec3_scale(out, radius), vec3_scale(n, thickness));
			mesh_add_vertex(mesh, p, n, angle * radius / mesh->brush.repeat, (double)k / sides);
		}
	}
	for (uint32_t s = 0; s < (uint32_t)segments && !mesh->failed; s++) {
		for (uint32_t k = 0; k < (uint32_t)sides; k++) {
			uint32_t v = first + s * stride + k;
			add_quad(mesh, v, v + 1, v + stride + 1, v + stride);
		}
	}
	if (to - from < 2.0 * SCENE_PI - 1e-9) {
		torus_end(mesh, radius, thickness, from, -1.0, sides);
		torus_end(mesh, radius, thickness, to, 1.0, sides);
	}
}

void mesh_card(struct mesh *mesh, struct vec3 center, struct vec3 right, struct vec3 up, struct vec3 normal)
{
	struct vec3 across = vec3_cross(right, up);
	uint8_t sway = mesh->brush.sway;
	uint32_t v[4];
	for (int i = 0; i < 4; i++) {
		double x = (i == 1 || i == 2) ? 1.0 : 0.0, y = i >= 2 ? 1.0 : 0.0;
		struct vec3 p = vec3_add(center, vec3_add(vec3_scale(right, x - 0.5), vec3_scale(up, y - 0.5)));
		mesh->brush.sway = y > 0.0 ? sway : sway / 2;
		v[i] = mesh_add_vertex(mesh, p, normal, x, y);
	}
	mesh->brush.sway = sway;
	/* Both sides, with the one given normal: leaves are lit through. */
	add_quad(mesh, v[0], v[1], v[2], v[3]);
	if (mesh->failed || vec3_length(across) <= 0.0 || mesh->index_count < 6)
		return;
	const uint32_t *last = mesh->indices + mesh->index_count - 6;
	uint32_t back[6] = {last[0], last[2], last[1], last[3], last[5], last[4]};
	for (int i = 0; i < 6; i++) {
		if (!grow((void **)&mesh->indices, &mesh->index_capacity, mesh->index_count, sizeof(*mesh->indices))) {
			mesh->failed = true;
			return;
		}
		mesh->indices[mesh->index_count++] = back[i];
	}
}
