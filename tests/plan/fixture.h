/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Frames for the tests of the plan, and an oracle: docs/method.md, 1 and 2, as
 * plain loops in double, written from the page and not from the analysis.
 */
#ifndef PURSUIT_TESTS_PLAN_FIXTURE_H
#define PURSUIT_TESTS_PLAN_FIXTURE_H

#include "daemon/engine/plan.h"

struct fixture_spec {
	uint32_t width, height;
	uint32_t motion_format;               /* 0: no motion */
	uint32_t motion_width, motion_height; /* 0: as the picture */
	uint32_t depth_format;                /* 0: no depth */
	uint32_t depth_width, depth_height;
	uint32_t depth_kind; /* 0: device */
	float near_distance, far_distance;
};

struct fixture {
	struct frame frame;
	uint8_t *memory; /* motion, then depth */
	size_t bytes;
	uint8_t *motion, *depth;
	const struct pursuit_plane *motion_plane, *depth_plane;
};

/* All motion 0, all depth 0, backward, T = S = 25 ms. Never fails. */
void fixture_make(struct fixture *fixture, const struct fixture_spec *spec);
void fixture_finish(struct fixture *fixture);

/* In pixels of the plane. Halves are rounded down in magnitude. */
void fixture_set_motion(struct fixture *fixture, uint32_t x, uint32_t y, double mx, double my);
void fixture_set_motion_bits(struct fixture *fixture, uint32_t x, uint32_t y, uint32_t bits_x, uint32_t bits_y);
/* Value from 0 to 1 for integer formats, any float for DEPTH32F. */
void fixture_set_depth(struct fixture *fixture, uint32_t x, uint32_t y, double value);

/* Deterministic numbers. */
uint32_t random_next(uint32_t *state);
/* Multiples of a quarter from -range to range. */
double random_quarter(uint32_t *state, int range);

/* Fields to test with. */
enum fixture_field {
	FIELD_STILL,
	FIELD_CONSTANT,
	FIELD_SMOOTH, /* a rotation: small gradients */
	FIELD_LAYERS, /* discs and bars at several depths */
	FIELD_RANDOM, /* quarters, a discontinuity everywhere */
	FIELD_SPARSE, /* single pixels that differ */
	FIELD_FLOATS, /* random numbers that are no quarters */
	FIELD_FAST,   /* beyond the tracking limit */
	FIELD_BITS,   /* random bits: NaN, infinite, denormal, huge */
	FIELD_COUNT,
};
const char *fixture_field_name(enum fixture_field field);
void fixture_fill(struct fixture *fixture, enum fixture_field field, uint32_t seed);

/* Both diagonals are right as far as singles can tell. */
#define ORACLE_EITHER 2u

/* What the page says the plan is. */
struct oracle {
	uint32_t columns, rows;
	struct oracle_vertex {
		double x, y, ux, uy, z;
		int snapped;
		int loose; /* hangs on less than singles can tell */
	} * vertices;
	uint32_t *diagonals; /* by quad: 1 is v00 v11, 0 is v10 v01 */
	uint32_t quads;
	uint32_t loose; /* vertices that are */
	uint32_t snapped, folded_least, folded_most, doubtful_least, doubtful_most;
	uint64_t invalid;
	int still;
	double max_displacement;
	double slack; /* of u, from damping in singles */
};
void oracle_make(struct oracle *oracle, const struct fixture *fixture, const struct plan_params *params);
void oracle_finish(struct oracle *oracle);

/* Equal bits: all that plan_make() says of a frame. */
bool fixture_same_plan(const struct plan *a, const struct plan *b);

#endif
