/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Grids at their limits: all snapped, none, folded, collapsed, gone; depth of every kind. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "suite.h"

#define WIDTH 120.0
#define HEIGHT 80.0

static void one_alike(void *context, double x, double y, double m[2])
{
	m[0] = 3.25;
	m[1] = -1.5;
}

/* A discontinuity within each cell. */
static void stripes(void *context, double x, double y, double m[2])
{
	m[0] = fmod(x, 8.0) < 4.0 ? 1.0 : -1.0;
	m[1] = fmod(y, 8.0) < 4.0 ? 0.75 : -0.75;
}

/* Towards the middle by so many times the distance: 1 collapses at phase 1, 2 turns everything over. */
static void inwards(void *context, double x, double y, double m[2])
{
	const double share = *(const double *)context;
	m[0] = share * (WIDTH / 2.0 - x);
	m[1] = share * (HEIGHT / 2.0 - y);
}

static void away(void *context, double x, double y, double m[2])
{
	m[0] = 65504.0;
	m[1] = -65504.0;
}

struct field {
	const char *name;
	void (*motion)(void *context, double x, double y, double m[2]);
	double context, last_phase;
};

static const struct field fields[] = {
	{"none snapped", one_alike, 0.0, 2.0 / 3.0},         {"every vertex snapped", stripes, 0.0, 2.0 / 3.0},
	{"collapsed to nothing", inwards, 1.0, 1.0},         {"collapsed nearly", inwards, 1.4999, 2.0 / 3.0},
	{"whole grid turned over", inwards, 4.0, 2.0 / 3.0}, {"whole grid turned over, far", inwards, 60.0, 8.0},
	{"all motion out of the picture", away, 0.0, 1.0},
};

static void check_fields(struct suite *suite)
{
	struct input input;
	input_make(&input, &(struct input_spec){
						   .width = 120, .height = 80, .image = INPUT_EDGES, .field = INPUT_LAYERS, .seed = 2});
	for (size_t i = 0; i < sizeof(fields) / sizeof(fields[0]); i++) {
		char name[TABLE_TEXT];
		double context = fields[i].context;
		suite_move(&input, fields[i].motion, &context);
		snprintf(name, sizeof(name), "%s: steps off the reference", fields[i].name);
		suite_against_reference(suite, name, &input.frame, &(struct engine_params){.viewing_distance_mm = 1e6f},
								fields[i].last_phase);
		snprintf(name, sizeof(name), "%s: undefined pixels", fields[i].name);
		suite_all_methods(suite, name, &input.frame);
	}
	input_finish(&input);
}

static void check_depths(struct suite *suite)
{
	static const struct {
		const char *name;
		uint32_t format, kind;
		float near_distance, far_distance;
		bool none;
	} depths[] = {
		{"none", 0, 0, 0.0f, 0.0f, true},
		{"device, 16 bit", PURSUIT_FORMAT_DEPTH16, PURSUIT_DEPTH_DEVICE, 0.0f, 0.0f, false},
		{"device, 24 bit", PURSUIT_FORMAT_DEPTH24, PURSUIT_DEPTH_DEVICE, 0.0f, 0.0f, false},
		{"device reversed, 32 bit", PURSUIT_FORMAT_DEPTH32F, PURSUIT_DEPTH_DEVICE_REVERSED, 0.0f, 0.0f, false},
		{"linear", PURSUIT_FORMAT_DEPTH32F, PURSUIT_DEPTH_LINEAR, 0.5f, 100.0f, false},
		{"linear, infinite far", PURSUIT_FORMAT_DEPTH32F, PURSUIT_DEPTH_LINEAR, 0.5f, HUGE_VALF, false},
	};
	char name[TABLE_TEXT];
	for (size_t i = 0; i < sizeof(depths) / sizeof(depths[0]); i++) {
		struct input input;
		input_make(&input, &(struct input_spec){.width = 120,
												.height = 80,
												.image = INPUT_EDGES,
												.field = INPUT_LAYERS,
												.seed = 12,
												.depth_format = depths[i].format,
												.depth_kind = depths[i].kind,
												.near_distance = depths[i].near_distance,
												.far_distance = depths[i].far_distance,
												.no_depth = depths[i].none});
		snprintf(name, sizeof(name), "depth %s: steps off the reference", depths[i].name);
		suite_against_reference(suite, name, &input.frame, &(struct engine_params){0}, 2.0 / 3.0);
		suite_all_methods(suite, "depth of each kind: undefined pixels", &input.frame);
		input_finish(&input);
	}
}

static void check_equal_depth(struct suite *suite)
{
	static const float values[] = {0.0f, 0.5f, 1.0f, -3.0f, 7.0f};
	struct input input;
	const struct pursuit_plane *plane;
	input_make(&input, &(struct input_spec){
						   .width = 120, .height = 80, .image = INPUT_EDGES, .field = INPUT_LAYERS, .seed = 13});
	uint8_t *data = suite_plane(&input, PURSUIT_ROLE_DEPTH, &plane);
	for (size_t v = 0; v < sizeof(values) / sizeof(values[0]); v++) {
		for (uint32_t j = 0; j < plane->height; j++)
			for (uint32_t i = 0; i < plane->width; i++)
				memcpy(data + j * plane->stride + 4 * i, &values[v], 4);
		suite_all_methods(suite, "depth all equal: undefined pixels", &input.frame);
	}
	input_finish(&input);
}

/* Where depths are steps of 1/8, 16 bits tell the same as 32. */
static void check_bits_of_depth(struct suite *suite)
{
	static const uint32_t formats[2] = {PURSUIT_FORMAT_DEPTH16, PURSUIT_FORMAT_DEPTH32F};
	uint8_t *pictures[2];
	uint32_t width = 0, height = 0;
	suite_method(suite, "pursuit", 120);
	for (int k = 0; k < 2; k++) {
		struct input input;
		const struct pursuit_plane *plane;
		input_make(&input, &(struct input_spec){.width = 120,
												.height = 80,
												.image = INPUT_EDGES,
												.field = INPUT_LAYERS,
												.seed = 14,
												.depth_format = formats[k]});
		uint8_t *data = suite_plane(&input, PURSUIT_ROLE_DEPTH, &plane);
		for (uint32_t j = 0; j < plane->height; j++)
			for (uint32_t i = 0; i < plane->width; i++) {
				const double z = floor((i + j) / 25.0) / 8.0;
				const float single = (float)z;
				const uint16_t word = (uint16_t)lrint(z * 65535.0);
				memcpy(data + j * plane->stride + (k ? 4 : 2) * i, k ? (const void *)&single : (const void *)&word,
					   k ? 4 : 2);
			}
		pictures[k] = suite_render(suite, &input.frame, ENGINE_SHOW_IN_BETWEEN, 2.0 / 3.0, &width, &height);
		input_finish(&input);
	}
	uint64_t worst = pictures[0] && pictures[1] ? 0 : 255;
	for (size_t i = 0; pictures[0] && pictures[1] && i < 4 * (size_t)width * height; i++) {
		const uint64_t off = (uint64_t)abs(pictures[0][i] - pictures[1][i]);
		worst = off > worst ? off : worst;
	}
	table_add(&suite->table, "depth of 16 against 32 bit: steps", (double)worst, "layers", 0.0);
	free(pictures[0]);
	free(pictures[1]);
}

void geometry_run(struct suite *suite)
{
	check_fields(suite);
	check_depths(suite);
	check_equal_depth(suite);
	check_bits_of_depth(suite);
}
