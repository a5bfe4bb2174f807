/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "input.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHAPES 6

struct shape {
	double x, y, rx, ry; /* centre and radii, as shares of the picture */
	bool box;
	double mx, my, depth, tilt;
};

/* What a seed decides. */
struct world {
	const struct input_spec *spec;
	struct shape shapes[SHAPES];
	double phase[6];
	uint64_t random;
};

uint64_t input_random(uint64_t *state)
{
	*state ^= *state >> 12;
	*state ^= *state << 25;
	*state ^= *state >> 27;
	return *state * UINT64_C(0x2545F4914F6CDD1D);
}

double input_uniform(uint64_t *state)
{
	return (double)(input_random(state) >> 11) / 9007199254740992.0;
}

static double between(uint64_t *state, double low, double high)
{
	return low + (high - low) * input_uniform(state);
}

uint16_t input_half(double value)
{
	const uint16_t sign = signbit(value) ? 0x8000 : 0;
	const double size = fabs(value);
	int exponent;
	if (isnan(value))
		return 0x7e00;
	if (size >= 65520.0)
		return sign | 0x7c00;
	if (size < ldexp(1.0, -14))
		return (uint16_t)(sign | (uint16_t)rint(ldexp(size, 24)));
	(void)frexp(size, &exponent);
	/* A carry out of the mantissa lands in the exponent, as it must. */
	const long mantissa = lrint(ldexp(size, 11 - exponent)) - 1024;
	return (uint16_t)(sign | (uint16_t)(((exponent + 14) << 10) + mantissa));
}

static void make_world(struct world *world, const struct input_spec *spec)
{
	world->spec = spec;
	world->random = spec->seed * UINT64_C(0x9E3779B97F4A7C15) + 88172645463325252u;
	for (int i = 0; i < 8; i++)
		input_random(&world->random);
	for (int i = 0; i < 6; i++)
		world->phase[i] = between(&world->random, 0.0, 6.2831853);
	for (int i = 0; i < SHAPES; i++) {
		struct shape *shape = &world->shapes[i];
		shape->x = input_uniform(&world->random);
		shape->y = input_uniform(&world->random);
		shape->rx = between(&world->random, 0.05, 0.25);
		shape->ry = between(&world->random, 0.05, 0.25);
		shape->box = input_random(&world->random) & 1;
		shape->mx = between(&world->random, -14.0, 14.0);
		shape->my = between(&world->random, -8.0, 8.0);
		shape->depth = 0.1 + 0.12 * i + between(&world->random, 0.0, 0.05);
		shape->tilt = between(&world->random, -0.02, 0.02);
	}
}

/* The nearest shape at a place (shares of the picture), NULL: background. */
static const struct shape *shape_at(const struct world *world, double x, double y)
{
	for (int i = 0; i < SHAPES; i++) {
		const struct shape *shape = &world->shapes[i];
		const double dx = fabs(x - shape->x) / shape->rx, dy = fabs(y - shape->y) / shape->ry;
		if (shape->box ? dx < 1.0 && dy < 1.0 : dx * dx + dy * dy < 1.0)
			return shape;
	}
	return NULL;
}

static void layers_at(const struct world *world, double x, double y, double m[2])
{
	const struct shape *shape = shape_at(world, x, y);
	m[0] = shape ? shape->mx : 2.0 + x;
	m[1] = shape ? shape->my : -1.0 + 0.5 * y;
}

static void broken_at(struct world *world, double m[2])
{
	static const double absurd[] = {(double)NAN, (double)INFINITY, -(double)INFINITY, 1e6, -3e38, 70000.0,
									1e-40,       66000.0};
	const uint64_t dice = input_random(&world->random);
	if (dice % 40 == 0)
		m[dice >> 32 & 1] = absurd[dice >> 40 & 7];
}

/* Motion at a place (shares of the picture), pixels of colour. */
static void motion_at(struct world *world, double x, double y, double m[2])
{
	const double w = world->spec->width, h = world->spec->height;
	m[0] = m[1] = 0.0;
	switch (world->spec->field) {
	case INPUT_STILL:
		break;
	case INPUT_TRANSLATE:
		m[0] = 3.0;
		m[1] = -2.0;
		break;
	case INPUT_SMOOTH:
		m[0] = 0.04 * w * sin(5.0 * x + 3.0 * y + world->phase[0]);
		m[1] = 0.04 * h * sin(4.0 * y - 3.0 * x + world->phase[1]);
		break;
	case INPUT_ROTATE:
		m[0] = -0.11 * (y - 0.47) * h;
		m[1] = 0.11 * (x - 0.53) * w;
		break;
	case INPUT_ZOOM:
		m[0] = 0.37 * (x - 0.47) * w;
		m[1] = 0.37 * (y - 0.53) * h;
		break;
	case INPUT_LAYERS:
		layers_at(world, x, y, m);
		break;
	case INPUT_VIOLENT:
		m[0] = between(&world->random, -40.0, 40.0);
		m[1] = between(&world->random, -40.0, 40.0);
		break;
	case INPUT_SHAKE:
		m[0] = between(&world->random, -5.0, 5.0);
		m[1] = between(&world->random, -5.0, 5.0);
		break;
	case INPUT_BROKEN:
		layers_at(world, x, y, m);
		broken_at(world, m);
		break;
	}
}

/* Device depth at a place, 0 near. */
static double depth_at(struct world *world, double x, double y)
{
	const struct shape *shape = shape_at(world, x, y);
	if (world->spec->field == INPUT_VIOLENT || world->spec->field == INPUT_SHAKE)
		return input_uniform(&world->random);
	return shape ? shape->depth + shape->tilt * x : 0.9 + 0.05 * x + 0.04 * y;
}

static double waves_at(const struct world *world, double x, double y, int c)
{
	const double *p = world->phase;
	return 0.5 + 0.22 * sin(7.0 * x + 2.0 * c + p[c]) + 0.22 * sin(6.0 * y - 3.0 * x + p[3 + c]);
}

/* Code value of one channel. */
static double color_at(struct world *world, double x, double y, int c)
{
	const struct shape *shape = shape_at(world, x, y);
	switch (world->spec->image) {
	case INPUT_NOISE:
		return input_uniform(&world->random);
	case INPUT_FLAT:
		return 0.2 + 0.25 * c;
	case INPUT_EDGES:
		if (shape)
			return ((shape - world->shapes) + c) & 1 ? 1.0 : 0.0;
		return waves_at(world, x, y, c);
	default:
		return waves_at(world, x, y, c);
	}
}

static void put_color(struct world *world, uint32_t format, double x, double y, uint8_t *to)
{
	double rgb[3];
	uint32_t word = 3u << 30;
	uint16_t halves[4] = {0, 0, 0, 0x3c00};
	for (int c = 0; c < 3; c++) {
		rgb[c] = color_at(world, x, y, c);
		word |= (uint32_t)lrint(rgb[c] * 1023.0) << (10 * c);
		halves[c] = input_half(rgb[c]);
		to[format == PURSUIT_FORMAT_BGRA8 ? 2 - c : c] = (uint8_t)lrint(rgb[c] * 255.0);
	}
	to[3] = (uint8_t)(input_random(&world->random) >> 56);
	if (format == PURSUIT_FORMAT_RGB10A2)
		memcpy(to, &word, sizeof(word));
	if (format == PURSUIT_FORMAT_RGBA16F && input_random(&world->random) % 50 == 0)
		halves[input_random(&world->random) % 3] =
			(uint16_t[]){0x7e00, 0x7c00, 0xfc00, 0xbc00, 0x4400, 0x0001}[input_random(&world->random) % 6];
	if (format == PURSUIT_FORMAT_RGBA16F)
		memcpy(to, halves, sizeof(halves));
}

/* Premultiplied: opaque, half and clear regions. */
static void put_ui(struct world *world, double x, double y, uint8_t *to)
{
	const double alpha = y < 0.2 ? 1.0 : y > 0.8 ? 0.5 : x < 0.1 ? x * 10.0 : 0.0;
	for (int c = 0; c < 3; c++)
		to[c] = (uint8_t)lrint(255.0 * alpha * waves_at(world, 3.0 * x, y, c));
	to[3] = (uint8_t)lrint(255.0 * alpha);
	if (x > 0.95 && alpha == 0.0)
		memset(to, 200, 3); /* additive: light without cover, clamps */
}

static void put_motion(struct world *world, uint32_t format, double x, double y, uint8_t *to)
{
	double m[2];
	motion_at(world, x, y, m);
	const float singles[2] = {(float)m[0], (float)m[1]};
	const uint16_t halves[2] = {input_half(m[0]), input_half(m[1])};
	if (format == PURSUIT_FORMAT_RG16F)
		memcpy(to, halves, sizeof(halves));
	else
		memcpy(to, singles, sizeof(singles));
}

static double encode_depth(const struct input_spec *spec, double z)
{
	const double near_distance = (double)spec->near_distance, far_distance = (double)spec->far_distance;
	if (spec->depth_kind == PURSUIT_DEPTH_DEVICE_REVERSED)
		return 1.0 - z;
	if (spec->depth_kind != PURSUIT_DEPTH_LINEAR)
		return z;
	if (isinf(far_distance))
		return near_distance / (1.0 - fmin(z, 0.9999));
	return far_distance > 0.0 ? near_distance + z * (far_distance - near_distance) : z / (1.0 - fmin(z, 0.9999));
}

static void put_depth(struct world *world, uint32_t format, double x, double y, uint8_t *to)
{
	double z = encode_depth(world->spec, depth_at(world, x, y));
	if (world->spec->field == INPUT_BROKEN && input_random(&world->random) % 60 == 0)
		z = (double[]){(double)NAN, -5.0, 17.0}[input_random(&world->random) % 3];
	const float single = (float)z;
	const double share = isnan(z) ? 1.0 : fmin(1.0, fmax(0.0, z));
	const uint16_t short_value = (uint16_t)lrint(share * 65535.0);
	const uint32_t word = (uint32_t)lrint(share * 16777215.0) | 0xa5000000u;
	if (format == PURSUIT_FORMAT_DEPTH16)
		memcpy(to, &short_value, sizeof(short_value));
	else if (format == PURSUIT_FORMAT_DEPTH24)
		memcpy(to, &word, sizeof(word));
	else
		memcpy(to, &single, sizeof(single));
}

static void put(struct world *world, const struct pursuit_plane *plane, double x, double y, uint8_t *to)
{
	switch (plane->role) {
	case PURSUIT_ROLE_COLOR:
		put_color(world, plane->format, x, y, to);
		break;
	case PURSUIT_ROLE_DEPTH:
		put_depth(world, plane->format, x, y, to);
		break;
	case PURSUIT_ROLE_MOTION:
		put_motion(world, plane->format, x, y, to);
		break;
	default:
		put_ui(world, x, y, to);
		break;
	}
}

static void add_plane(struct pursuit_frame_header *header, uint32_t role, uint32_t format, uint32_t width,
					  uint32_t height)
{
	struct pursuit_plane *plane = &header->planes[header->plane_count++];
	plane->role = role;
	plane->format = format;
	plane->width = width;
	plane->height = height;
}

static void add_planes(struct pursuit_frame_header *header, const struct input_spec *spec)
{
	const uint32_t w = spec->width, h = spec->height;
	add_plane(header, PURSUIT_ROLE_COLOR, spec->color_format ? spec->color_format : PURSUIT_FORMAT_BGRA8, w, h);
	header->planes[0].transfer = spec->transfer;
	if (!spec->transfer.curve)
		header->planes[0].transfer.curve = PURSUIT_CURVE_SRGB;
	if (!spec->no_depth) {
		add_plane(header, PURSUIT_ROLE_DEPTH, spec->depth_format ? spec->depth_format : PURSUIT_FORMAT_DEPTH32F,
				  spec->depth_width ? spec->depth_width : w, spec->depth_height ? spec->depth_height : h);
		header->depth_kind = spec->depth_kind ? spec->depth_kind : PURSUIT_DEPTH_DEVICE;
	}
	if (!spec->no_motion) {
		add_plane(header, PURSUIT_ROLE_MOTION, spec->motion_format ? spec->motion_format : PURSUIT_FORMAT_RG32F,
				  spec->motion_width ? spec->motion_width : w, spec->motion_height ? spec->motion_height : h);
		header->motion_kind = spec->motion_kind ? spec->motion_kind : PURSUIT_MOTION_BACKWARD;
	}
	if (spec->ui_format)
		add_plane(header, PURSUIT_ROLE_UI, spec->ui_format, w, h);
}

static void fill_plane(struct world *world, const struct pursuit_plane *plane, uint8_t *to)
{
	const uint32_t bytes = pursuit_format_bytes(plane->format);
	for (uint32_t j = 0; j < plane->height; j++)
		for (uint32_t i = 0; i < plane->width; i++)
			put(world, plane, (i + 0.5) / plane->width, (j + 0.5) / plane->height,
				to + j * plane->stride + (size_t)i * bytes);
}

void input_make(struct input *input, const struct input_spec *spec)
{
	struct pursuit_frame_header *header = &input->frame.header;
	struct world world;
	struct error error;

	*input = (struct input){0};
	make_world(&world, spec);
	header->frame_id = 1;
	header->flags = spec->flags;
	header->real_interval_ns = spec->real_interval_ns == 1 ? 0
							   : spec->real_interval_ns    ? spec->real_interval_ns
														   : 16666667;
	header->motion_interval_ns = spec->motion_interval_ns;
	header->near_distance = spec->near_distance;
	header->far_distance = spec->far_distance;
	add_planes(header, spec);
	const uint64_t bytes = frame_layout(header);
	input->memory = calloc(1, bytes);
	if (!input->memory || frame_validate(header, bytes, NULL, NULL, &error) != 0) {
		fprintf(stderr, "%s\n", input->memory ? error.text : "no memory");
		abort();
	}
	for (uint32_t i = 0; i < header->plane_count; i++) {
		input->frame.planes[i] = input->memory + header->planes[i].offset;
		fill_plane(&world, &header->planes[i], input->memory + header->planes[i].offset);
	}
}

float input_display_mm(uint32_t width)
{
	return width < 4 ? 1.0f : 0.27f * (float)width;
}

void input_finish(struct input *input)
{
	free(input->memory);
	*input = (struct input){0};
}
