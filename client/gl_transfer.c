/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "client/gl_transfer.h"

#include <stddef.h>

#include "client/gl_api.h"
#include "proto/frame.h"

/* One way to fill a plane, tried in order. */
struct way {
	uint32_t plane;
	uint32_t format;
	uint32_t type;
	uint32_t pixel_bytes;
	uint32_t channels;
	shim_row row;
};

static const struct way desktop_ways[] = {
	{PURSUIT_FORMAT_BGRA8, SHIM_GL_BGRA, SHIM_GL_UNSIGNED_BYTE, 4, 4, shim_row_copy},
	{PURSUIT_FORMAT_RGBA8, SHIM_GL_RGBA, SHIM_GL_UNSIGNED_BYTE, 4, 4, shim_row_copy},
	{PURSUIT_FORMAT_RGB10A2, SHIM_GL_RGBA, SHIM_GL_UNSIGNED_INT_2_10_10_10_REV, 4, 4, shim_row_copy},
	{PURSUIT_FORMAT_RGBA16F, SHIM_GL_RGBA, SHIM_GL_HALF_FLOAT, 8, 4, shim_row_copy},
	{PURSUIT_FORMAT_DEPTH32F, SHIM_GL_RED, SHIM_GL_FLOAT, 4, 1, shim_row_copy},
	{PURSUIT_FORMAT_DEPTH16, SHIM_GL_RED, SHIM_GL_FLOAT, 4, 1, shim_row_depth16},
	{PURSUIT_FORMAT_DEPTH24, SHIM_GL_RED, SHIM_GL_FLOAT, 4, 1, shim_row_depth24},
	{PURSUIT_FORMAT_RG16F, SHIM_GL_RG, SHIM_GL_HALF_FLOAT, 4, 2, shim_row_motion_half},
	{PURSUIT_FORMAT_RG32F, SHIM_GL_RG, SHIM_GL_FLOAT, 8, 2, shim_row_motion_float},
	{PURSUIT_FORMAT_R8UI, SHIM_GL_RED_INTEGER, SHIM_GL_UNSIGNED_INT, 4, 1, shim_row_id8},
	{PURSUIT_FORMAT_R16UI, SHIM_GL_RED_INTEGER, SHIM_GL_UNSIGNED_INT, 4, 1, shim_row_id16},
	{PURSUIT_FORMAT_R32UI, SHIM_GL_RED_INTEGER, SHIM_GL_UNSIGNED_INT, 4, 1, shim_row_copy},
};

/* First those that the driver must choose, then the portable ones. */
static const struct way es_ways[] = {
	{PURSUIT_FORMAT_BGRA8, SHIM_GL_BGRA, SHIM_GL_UNSIGNED_BYTE, 4, 4, shim_row_copy},
	{PURSUIT_FORMAT_BGRA8, SHIM_GL_RGBA, SHIM_GL_UNSIGNED_BYTE, 4, 4, shim_row_swap},
	{PURSUIT_FORMAT_RGBA8, SHIM_GL_RGBA, SHIM_GL_UNSIGNED_BYTE, 4, 4, shim_row_copy},
	{PURSUIT_FORMAT_RGB10A2, SHIM_GL_RGBA, SHIM_GL_UNSIGNED_INT_2_10_10_10_REV, 4, 4, shim_row_copy},
	{PURSUIT_FORMAT_RGBA16F, SHIM_GL_RGBA, SHIM_GL_HALF_FLOAT, 8, 4, shim_row_copy},
	{PURSUIT_FORMAT_RGBA16F, SHIM_GL_RGBA, SHIM_GL_FLOAT, 16, 4, shim_row_color_half},
	{PURSUIT_FORMAT_DEPTH32F, SHIM_GL_RED, SHIM_GL_FLOAT, 4, 1, shim_row_copy},
	{PURSUIT_FORMAT_DEPTH32F, SHIM_GL_RGBA, SHIM_GL_FLOAT, 16, 4, shim_row_depth_float},
	{PURSUIT_FORMAT_DEPTH16, SHIM_GL_RED, SHIM_GL_FLOAT, 4, 1, shim_row_depth16},
	{PURSUIT_FORMAT_DEPTH16, SHIM_GL_RGBA, SHIM_GL_FLOAT, 16, 4, shim_row_depth16},
	{PURSUIT_FORMAT_DEPTH24, SHIM_GL_RED, SHIM_GL_FLOAT, 4, 1, shim_row_depth24},
	{PURSUIT_FORMAT_DEPTH24, SHIM_GL_RGBA, SHIM_GL_FLOAT, 16, 4, shim_row_depth24},
	{PURSUIT_FORMAT_RG16F, SHIM_GL_RG, SHIM_GL_HALF_FLOAT, 4, 2, shim_row_motion_half},
	{PURSUIT_FORMAT_RG16F, SHIM_GL_RG, SHIM_GL_FLOAT, 8, 2, shim_row_motion_to_half},
	{PURSUIT_FORMAT_RG16F, SHIM_GL_RGBA, SHIM_GL_FLOAT, 16, 4, shim_row_motion_to_half},
	{PURSUIT_FORMAT_RG32F, SHIM_GL_RG, SHIM_GL_FLOAT, 8, 2, shim_row_motion_float},
	{PURSUIT_FORMAT_RG32F, SHIM_GL_RGBA, SHIM_GL_FLOAT, 16, 4, shim_row_motion_float},
	{PURSUIT_FORMAT_R8UI, SHIM_GL_RED_INTEGER, SHIM_GL_UNSIGNED_INT, 4, 1, shim_row_id8},
	{PURSUIT_FORMAT_R8UI, SHIM_GL_RED_INTEGER, SHIM_GL_UNSIGNED_BYTE, 1, 1, shim_row_copy},
	{PURSUIT_FORMAT_R8UI, SHIM_GL_RGBA_INTEGER, SHIM_GL_UNSIGNED_INT, 16, 4, shim_row_id8},
	{PURSUIT_FORMAT_R16UI, SHIM_GL_RED_INTEGER, SHIM_GL_UNSIGNED_INT, 4, 1, shim_row_id16},
	{PURSUIT_FORMAT_R16UI, SHIM_GL_RED_INTEGER, SHIM_GL_UNSIGNED_SHORT, 2, 1, shim_row_copy},
	{PURSUIT_FORMAT_R16UI, SHIM_GL_RGBA_INTEGER, SHIM_GL_UNSIGNED_INT, 16, 4, shim_row_id16},
	{PURSUIT_FORMAT_R32UI, SHIM_GL_RED_INTEGER, SHIM_GL_UNSIGNED_INT, 4, 1, shim_row_copy},
	{PURSUIT_FORMAT_R32UI, SHIM_GL_RGBA_INTEGER, SHIM_GL_UNSIGNED_INT, 16, 4, shim_row_id32},
};

/* OpenGL ES 3.0, Section 4.3.2: what every driver reads from a texture of this kind. */
static bool is_portable(const struct way *way, const struct shim_gl_source *source)
{
	switch (source->component_type) {
	case SHIM_GL_UNSIGNED_NORMALIZED:
		return way->format == SHIM_GL_RGBA &&
			   (way->type == SHIM_GL_UNSIGNED_BYTE ||
				(way->type == SHIM_GL_UNSIGNED_INT_2_10_10_10_REV && source->red_bits == 10));
	case SHIM_GL_FLOAT:
		return way->format == SHIM_GL_RGBA && way->type == SHIM_GL_FLOAT;
	case SHIM_GL_UNSIGNED_INT:
		return way->format == SHIM_GL_RGBA_INTEGER && way->type == SHIM_GL_UNSIGNED_INT;
	default:
		return false;
	}
}

static bool is_readable(const struct way *way, const struct shim_gl_source *source)
{
	bool driver = way->format == source->driver_format && way->type == source->driver_type;
	return !source->es || driver || is_portable(way, source);
}

static const char *check_kind(uint32_t role, const struct shim_gl_source *source)
{
	bool integer = source->component_type == SHIM_GL_UNSIGNED_INT || source->component_type == SHIM_GL_INT;

	if (source->is_depth) {
		return role != PURSUIT_ROLE_DEPTH ? "it is a depth texture"
			   : source->es               ? "GLES reads no depth textures"
										  : NULL;
	}
	if (role == PURSUIT_ROLE_OBJECT_ID) {
		return source->component_type == SHIM_GL_UNSIGNED_INT ? NULL : "its format is not an unsigned integer one";
	}
	if (role == PURSUIT_ROLE_MOTION && source->component_type != SHIM_GL_FLOAT) {
		return "its format is not a float one";
	}
	return integer ? "its format is an integer one" : NULL;
}

const char *shim_gl_transfer_choose(struct shim_gl_transfer *transfer, uint32_t role, uint32_t format,
									const struct shim_gl_source *source)
{
	const struct way *ways = source->es ? es_ways : desktop_ways;
	size_t count = source->es ? sizeof(es_ways) / sizeof(*es_ways) : sizeof(desktop_ways) / sizeof(*desktop_ways);
	const char *wrong = check_kind(role, source);

	for (size_t i = 0; i < count && !wrong; i++) {
		if (ways[i].plane == format && is_readable(&ways[i], source)) {
			*transfer = (struct shim_gl_transfer){
				.format = source->is_depth ? SHIM_GL_DEPTH_COMPONENT : ways[i].format,
				.type = ways[i].type,
				.pixel_bytes = ways[i].pixel_bytes,
				.row = ways[i].row,
				.options = {.channels = ways[i].channels, .pixel_bytes = ways[i].pixel_bytes},
			};
			return NULL;
		}
	}
	return wrong ? wrong : "GLES cannot read its format as the plane's";
}
