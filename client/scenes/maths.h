/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Vectors, matrices and integer hashes of the scenes. Double precision until
 * the upload, so that equal times give equal bits and far times stay exact.
 * Matrices are column-major, as GL has them.
 */
#ifndef PURSUIT_SCENES_MATHS_H
#define PURSUIT_SCENES_MATHS_H

#include <math.h>
#include <stdint.h>

#define SCENE_PI 3.14159265358979323846

struct vec3 {
	double x, y, z;
};

struct mat4 {
	double m[16];
};

static inline struct vec3 vec3(double x, double y, double z)
{
	return (struct vec3){x, y, z};
}

static inline struct vec3 vec3_add(struct vec3 a, struct vec3 b)
{
	return vec3(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline struct vec3 vec3_sub(struct vec3 a, struct vec3 b)
{
	return vec3(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline struct vec3 vec3_scale(struct vec3 a, double s)
{
	return vec3(a.x * s, a.y * s, a.z * s);
}

static inline double vec3_dot(struct vec3 a, struct vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct vec3 vec3_cross(struct vec3 a, struct vec3 b)
{
	return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline double vec3_length(struct vec3 a)
{
	return sqrt(vec3_dot(a, a));
}

static inline struct vec3 vec3_normalize(struct vec3 a)
{
	double length = vec3_length(a);
	return length > 0.0 ? vec3_scale(a, 1.0 / length) : vec3(0, 1, 0);
}

static inline struct vec3 vec3_mix(struct vec3 a, struct vec3 b, double t)
{
	return vec3_add(vec3_scale(a, 1.0 - t), vec3_scale(b, t));
}

static inline struct mat4 mat4_identity(void)
{
	return (struct mat4){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
}

static inline struct mat4 mat4_multiply(struct mat4 a, struct mat4 b)
{
	struct mat4 r;
	for (int c = 0; c < 4; c++) {
		for (int row = 0; row < 4; row++) {
			double sum = 0.0;
			for (int k = 0; k < 4; k++)
				sum += a.m[k * 4 + row] * b.m[c * 4 + k];
			r.m[c * 4 + row] = sum;
		}
	}
	return r;
}

static inline struct mat4 mat4_translation(double x, double y, double z)
{
	return (struct mat4){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1}};
}

static inline struct mat4 mat4_scaling(double x, double y, double z)
{
	return (struct mat4){{x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0, 0, 0, 0, 1}};
}

static inline struct mat4 mat4_rotation_x(double angle)
{
	double c = cos(angle), s = sin(angle);
	return (struct mat4){{1, 0, 0, 0, 0, c, s, 0, 0, -s, c, 0, 0, 0, 0, 1}};
}

static inline struct mat4 mat4_rotation_y(double angle)
{
	double c = cos(angle), s = sin(angle);
	return (struct mat4){{c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, 0, 0, 0, 1}};
}

static inline struct mat4 mat4_rotation_z(double angle)
{
	double c = cos(angle), s = sin(angle);
	return (struct mat4){{c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
}

static inline struct vec3 mat4_point(const struct mat4 *a, struct vec3 p)
{
	const double *m = a->m;
	return vec3(m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12], m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
				m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]);
}

static inline struct vec3 mat4_direction(const struct mat4 *a, struct vec3 p)
{
	const double *m = a->m;
	return vec3(m[0] * p.x + m[4] * p.y + m[8] * p.z, m[1] * p.x + m[5] * p.y + m[9] * p.z,
				m[2] * p.x + m[6] * p.y + m[10] * p.z);
}

/* The inverse of a rotation followed by a translation. */
static inline struct mat4 mat4_rigid_inverse(const struct mat4 *a)
{
	const double *m = a->m;
	struct mat4 r = {{m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0, 0, 0, 0, 1}};
	struct vec3 t = mat4_direction(&r, vec3(m[12], m[13], m[14]));
	r.m[12] = -t.x;
	r.m[13] = -t.y;
	r.m[14] = -t.z;
	return r;
}

/* The frame whose z axis is `axis`, at `origin`: for limbs, beams and cards. */
static inline struct mat4 mat4_along(struct vec3 origin, struct vec3 axis)
{
	struct vec3 z = vec3_normalize(axis);
	struct vec3 up = fabs(z.y) < 0.95 ? vec3(0, 1, 0) : vec3(1, 0, 0);
	struct vec3 x = vec3_normalize(vec3_cross(up, z));
	struct vec3 y = vec3_cross(z, x);
	return (struct mat4){{x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, origin.x, origin.y, origin.z, 1}};
}

/* World to eye: looks from `eye` at `target`, the world's y up. */
static inline struct mat4 mat4_look_at(struct vec3 eye, struct vec3 target)
{
	struct vec3 back = vec3_normalize(vec3_sub(eye, target));
	struct vec3 right = vec3_normalize(vec3_cross(vec3(0, 1, 0), back));
	struct vec3 up = vec3_cross(back, right);
	struct mat4 pose = {
		{right.x, right.y, right.z, 0, up.x, up.y, up.z, 0, back.x, back.y, back.z, 0, eye.x, eye.y, eye.z, 1}};
	return mat4_rigid_inverse(&pose);
}

/* GL clip space; fov_y in radians. */
static inline struct mat4 mat4_perspective(double fov_y, double aspect, double near, double far)
{
	double f = 1.0 / tan(fov_y * 0.5);
	return (struct mat4){{f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0,
						  2.0 * far * near / (near - far), 0}};
}

static inline uint32_t scene_hash(uint32_t x)
{
	x ^= x >> 16;
	x *= 0x7feb352du;
	x ^= x >> 15;
	x *= 0x846ca68bu;
	x ^= x >> 16;
	return x;
}

static inline uint32_t scene_hash2(uint32_t x, uint32_t y)
{
	return scene_hash(x + 0x9e3779b9u * scene_hash(y + 0x85ebca6bu));
}

/* In [0, 1), from two integers. */
static inline double scene_random(uint32_t x, uint32_t y)
{
	return (double)(scene_hash2(x, y) >> 8) * (1.0 / 16777216.0);
}

/* The phase in [0, 1) of something that repeats every `period` seconds; any finite time. */
static inline double scene_phase(double time, double period)
{
	double phase = fmod(time, period) / period;
	return phase < 0.0 ? phase + 1.0 : phase;
}

/* sin of a whole number of turns per `period`. */
static inline double scene_wave(double time, double period, double offset)
{
	return sin(2.0 * SCENE_PI * (scene_phase(time, period) + offset));
}

static inline double scene_smooth(double low, double high, double x)
{
	double t = (x - low) / (high - low);
	t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
	return t * t * (3.0 - 2.0 * t);
}

#endif
