/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void add_plane(struct fixture *fixture, uint32_t role, uint32_t format, uint32_t width, uint32_t height)
{
	struct pursuit_frame_header *header = &fixture->frame.header;
	struct pursuit_plane *plane = &header->planes[header->plane_count++];
	*plane = (struct pursuit_plane){
		.role = role, .format = format, .storage = PURSUIT_STORAGE_MEMORY, .width = width, .height = height};
	plane->stride = ((uint64_t)width * pursuit_format_bytes(format) + 63) / 64 * 64;
	plane->size = plane->stride * height;
	plane->offset = fixture->bytes;
	if (role != PURSUIT_ROLE_COLOR)
		fixture->bytes += plane->size;
}

static uint32_t or_else(uint32_t value, uint32_t otherwise)
{
	return value ? value : otherwise;
}

static void fill_header(struct pursuit_frame_header *header, const struct fixture_spec *spec)
{
	header->frame_id = 7;
	header->real_interval_ns = 25000000;
	header->motion_kind = spec->motion_format ? PURSUIT_MOTION_BACKWARD : PURSUIT_MOTION_NONE;
	header->depth_kind = spec->depth_format ? or_else(spec->depth_kind, PURSUIT_DEPTH_DEVICE) : PURSUIT_DEPTH_NONE;
	header->near_distance = spec->near_distance;
	header->far_distance = spec->far_distance;
}

void fixture_make(struct fixture *fixture, const struct fixture_spec *spec)
{
	*fixture = (struct fixture){0};
	struct frame *frame = &fixture->frame;
	uint32_t w = spec->width, h = spec->height;
	fill_header(&frame->header, spec);
	add_plane(fixture, PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_BGRA8, w, h);
	if (spec->motion_format) {
		fixture->motion_plane = &frame->header.planes[frame->header.plane_count];
		add_plane(fixture, PURSUIT_ROLE_MOTION, spec->motion_format, or_else(spec->motion_width, w),
				  or_else(spec->motion_height, h));
	}
	if (spec->depth_format) {
		fixture->depth_plane = &frame->header.planes[frame->header.plane_count];
		add_plane(fixture, PURSUIT_ROLE_DEPTH, spec->depth_format, or_else(spec->depth_width, w),
				  or_else(spec->depth_height, h));
	}
	fixture->memory = calloc(1, fixture->bytes + 1);
	if (!fixture->memory)
		abort();
	for (uint32_t i = 1; i < frame->header.plane_count; i++)
		frame->planes[i] = fixture->memory + frame->header.planes[i].offset;
	if (fixture->motion_plane)
		fixture->motion = fixture->memory + fixture->motion_plane->offset;
	if (fixture->depth_plane)
		fixture->depth = fixture->memory + fixture->depth_plane->offset;
}

void fixture_finish(struct fixture *fixture)
{
	free(fixture->memory);
	*fixture = (struct fixture){0};
}

static uint16_t half_from(double value)
{
	uint16_t sign = signbit(value) ? 0x8000 : 0;
	double magnitude = fabs(value);
	if (isnan(value))
		return 0x7e00;
	if (magnitude > 65504)
		return (uint16_t)(sign | 0x7c00);
	if (magnitude < ldexp(1, -14))
		return (uint16_t)(sign | (uint16_t)floor(ldexp(magnitude, 24)));
	int exponent;
	double mantissa = frexp(magnitude, &exponent);
	return (uint16_t)(sign | (uint16_t)((exponent + 14) << 10 | ((int)floor(ldexp(mantissa, 11)) & 0x3ff)));
}

static uint32_t float_bits(double value)
{
	float single = (float)value;
	uint32_t bits;
	memcpy(&bits, &single, 4);
	return bits;
}

void fixture_set_motion_bits(struct fixture *fixture, uint32_t x, uint32_t y, uint32_t bits_x, uint32_t bits_y)
{
	uint8_t *row = fixture->motion + y * fixture->motion_plane->stride;
	if (fixture->motion_plane->format == PURSUIT_FORMAT_RG16F) {
		uint16_t halves[2] = {(uint16_t)bits_x, (uint16_t)bits_y};
		memcpy(row + 4 * (size_t)x, halves, 4);
	} else {
		uint32_t words[2] = {bits_x, bits_y};
		memcpy(row + 8 * (size_t)x, words, 8);
	}
}

void fixture_set_motion(struct fixture *fixture, uint32_t x, uint32_t y, double mx, double my)
{
	bool half = fixture->motion_plane->format == PURSUIT_FORMAT_RG16F;
	fixture_set_motion_bits(fixture, x, y, half ? half_from(mx) : float_bits(mx),
							half ? half_from(my) : float_bits(my));
}

void fixture_set_depth(struct fixture *fixture, uint32_t x, uint32_t y, double value)
{
	uint8_t *row = fixture->depth + y * fixture->depth_plane->stride;
	uint16_t word16 = (uint16_t)(value * 65535.0 + 0.5);
	uint32_t word;
	switch (fixture->depth_plane->format) {
	case PURSUIT_FORMAT_DEPTH16:
		memcpy(row + 2 * (size_t)x, &word16, 2);
		return;
	case PURSUIT_FORMAT_DEPTH24:
		word = (uint32_t)(value * 16777215.0 + 0.5) | (x * 37 & 0xff) << 24;
		break;
	default:
		word = float_bits(value);
	}
	memcpy(row + 4 * (size_t)x, &word, 4);
}

uint32_t random_next(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	uint32_t x = *state;
	x ^= x >> 16;
	x *= 0x7feb352du;
	x ^= x >> 15;
	x *= 0x846ca68bu;
	return x ^ x >> 16;
}

double random_quarter(uint32_t *state, int range)
{
	return (double)(random_next(state) % (uint32_t)(8 * range + 1)) / 4.0 - range;
}

const char *fixture_field_name(enum fixture_field field)
{
	static const char *const names[FIELD_COUNT] = {"still",  "constant", "smooth", "layers", "random",
												   "sparse", "floats",   "fast",   "bits"};
	return names[field];
}

struct sample {
	double mx, my, depth;
};

/* Discs and a lattice over a moving ground, in steps of a quarter pixel. */
static struct sample layers_at(double x, double y)
{
	for (int i = 0; i < 7; i++) {
		double cx = 37.0 + 61.0 * i, cy = 29.0 + 47.0 * (i * 5 % 7);
		if (hypot(fmod(x, 420.0) - cx, fmod(y, 330.0) - cy) < 9.0 + 4.0 * i)
			return (struct sample){2.25 * (i - 3), 1.5 * (i % 3) - 0.75, 0.1 + 0.05 * i};
	}
	if (fmod(x + 0.5 * y, 53.0) < 4.0)
		return (struct sample){-6.5, 0.25, 0.5};
	return (struct sample){1.25, 0, 0.75};
}

static struct sample sample_at(enum fixture_field field, double x, double y, double w, double h, uint32_t *state)
{
	switch (field) {
	case FIELD_CONSTANT:
		return (struct sample){3.25, -1.5, 0.5};
	case FIELD_SMOOTH:
		return (struct sample){(y - h / 2) / 64, (w / 2 - x) / 64, 0.5 + (x - y) / (4 * (w + h))};
	case FIELD_LAYERS:
		return layers_at(x, y);
	case FIELD_RANDOM:
		return (struct sample){random_quarter(state, 9), random_quarter(state, 9), random_next(state) % 5 / 4.0};
	case FIELD_SPARSE:
		if (random_next(state) % 97)
			return (struct sample){0, 0, 0.5};
		return (struct sample){random_quarter(state, 5), random_quarter(state, 5), random_next(state) % 3 / 2.0};
	case FIELD_FLOATS:
		return (struct sample){random_next(state) * 3e-9 - 6, random_next(state) * 3e-9 - 6,
							   random_next(state) * 0x1p-32};
	case FIELD_FAST:
		return (struct sample){random_next(state) * 2e-8 - 40, random_next(state) * 2e-8 - 40, 0.25};
	case FIELD_STILL:
	default:
		return (struct sample){0, 0, 0.5};
	}
}

static void fill_motion(struct fixture *fixture, enum fixture_field field, uint32_t *state)
{
	const struct pursuit_plane *plane = fixture->motion_plane;
	for (uint32_t y = 0; y < plane->height; y++)
		for (uint32_t x = 0; x < plane->width; x++) {
			struct sample at = sample_at(field, x, y, plane->width, plane->height, state);
			uint32_t bits_x = random_next(state), bits_y = random_next(state);
			if (field == FIELD_BITS)
				fixture_set_motion_bits(fixture, x, y, bits_x, bits_y);
			else
				fixture_set_motion(fixture, x, y, at.mx, at.my);
		}
}

void fixture_fill(struct fixture *fixture, enum fixture_field field, uint32_t seed)
{
	uint32_t state = seed;
	if (fixture->motion)
		fill_motion(fixture, field, &state);
	if (!fixture->depth)
		return;
	const struct pursuit_plane *plane = fixture->depth_plane;
	for (uint32_t y = 0; y < plane->height; y++)
		for (uint32_t x = 0; x < plane->width; x++) {
			double depth = sample_at(field, x, y, plane->width, plane->height, &state).depth;
			if (field == FIELD_BITS && plane->format == PURSUIT_FORMAT_DEPTH32F) {
				uint32_t bits = random_next(&state);
				memcpy(fixture->depth + y * plane->stride + 4 * (size_t)x, &bits, 4);
			} else {
				fixture_set_depth(fixture, x, y, depth);
			}
		}
}

static bool same_tiles(const struct plan *a, const struct plan *b)
{
	const size_t tiles = (size_t)plan_tiles_along(a->width) * plan_tiles_along(a->height);
	if (!a->invalid_tiles || !b->invalid_tiles)
		return a->invalid_tiles == b->invalid_tiles;
	return memcmp(a->invalid_tiles, b->invalid_tiles, tiles) == 0;
}

bool fixture_same_plan(const struct plan *a, const struct plan *b)
{
	if (a->rest != b->rest || a->columns != b->columns || a->rows != b->rows || a->index_count != b->index_count)
		return false;
	if (a->snapped != b->snapped || a->folded != b->folded || a->doubtful != b->doubtful)
		return false;
	if (a->invalid_pixels != b->invalid_pixels || memcmp(&a->max_displacement, &b->max_displacement, 4) != 0)
		return false;
	size_t vertices = (size_t)a->columns * a->rows;
	return a->rest != PLAN_MOVES ||
		   (same_tiles(a, b) && memcmp(a->vertices, b->vertices, vertices * sizeof(*a->vertices)) == 0 &&
			memcmp(a->indices, b->indices, a->index_count * sizeof(*a->indices)) == 0);
}
