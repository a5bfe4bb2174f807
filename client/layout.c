/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "client/layout.h"

#include <math.h>
#include <string.h>

#include "proto/shm.h"

#define DEFAULT_SLOTS 4u
#define PAGE_BYTES 4096u

static uint64_t align_up(uint64_t value, uint64_t alignment)
{
	return (value + alignment - 1) / alignment * alignment;
}

static bool color_is_valid(const struct pursuit_stream_params *params)
{
	switch (params->color_format) {
	case PURSUIT_COLOR_DEFAULT:
	case PURSUIT_COLOR_BGRA8:
	case PURSUIT_COLOR_RGBA8:
	case PURSUIT_COLOR_RGB10A2:
	case PURSUIT_COLOR_RGBA16F:
		break;
	default:
		return false;
	}
	switch (params->color_curve) {
	case PURSUIT_CURVE_DEFAULT:
	case PURSUIT_CURVE_IS_SRGB:
	case PURSUIT_CURVE_IS_LINEAR:
		return true;
	case PURSUIT_CURVE_IS_GAMMA:
		return params->color_gamma >= 1.0f && params->color_gamma <= 5.0f;
	default:
		return false;
	}
}

static bool depth_is_valid(const struct pursuit_stream_params *params)
{
	float near_distance = params->near_distance, far_distance = params->far_distance;
	bool near_known = isfinite(near_distance) && near_distance > 0.0f;
	bool far_known = far_distance > near_distance;

	if (!(near_distance == 0.0f || near_known) || !(far_distance == 0.0f || far_known)) {
		return false;
	}
	switch (params->depth_kind) {
	case PURSUIT_DEPTH_IS_DEVICE:
	case PURSUIT_DEPTH_IS_REVERSED:
		break;
	case PURSUIT_DEPTH_IS_LINEAR:
		if (params->depth_format != PURSUIT_DEPTH_ABSENT &&
			(params->depth_format != PURSUIT_DEPTH_FLOAT32 || !near_known || !far_known)) {
			return false;
		}
		break;
	default:
		return false;
	}
	return params->depth_format == PURSUIT_DEPTH_ABSENT || params->depth_format == PURSUIT_DEPTH_UNORM16 ||
		   params->depth_format == PURSUIT_DEPTH_UNORM24 || params->depth_format == PURSUIT_DEPTH_FLOAT32;
}

static bool others_are_valid(const struct pursuit_stream_params *params)
{
	bool motion = params->motion_format == PURSUIT_MOTION_ABSENT || params->motion_format == PURSUIT_MOTION_FLOAT16 ||
				  params->motion_format == PURSUIT_MOTION_FLOAT32;
	bool kind = params->motion_kind == PURSUIT_MOTION_IS_BACKWARD || params->motion_kind == PURSUIT_MOTION_IS_FORWARD;
	bool ui = params->ui_format == PURSUIT_UI_ABSENT || params->ui_format == PURSUIT_UI_BGRA8 ||
			  params->ui_format == PURSUIT_UI_RGBA8;
	bool object_id =
		params->object_id_format == PURSUIT_OBJECT_ID_ABSENT || params->object_id_format == PURSUIT_OBJECT_ID_UINT8 ||
		params->object_id_format == PURSUIT_OBJECT_ID_UINT16 || params->object_id_format == PURSUIT_OBJECT_ID_UINT32;
	bool slots =
		params->slot_count == 0 || (params->slot_count >= PURSUIT_MIN_SLOTS && params->slot_count <= PURSUIT_MAX_SLOTS);

	return motion && kind && ui && object_id && slots;
}

static bool size_is_valid(const struct pursuit_stream_params *params)
{
	return params->width >= 1 && params->width <= PURSUIT_MAX_SIZE && params->height >= 1 &&
		   params->height <= PURSUIT_MAX_SIZE && params->geometry_width <= PURSUIT_MAX_SIZE &&
		   params->geometry_height <= PURSUIT_MAX_SIZE;
}

/* Rows start on vector boundaries, like the planes themselves. */
static struct pursuit_plane *add_plane(struct shim_layout *layout, uint32_t role, uint32_t format, uint32_t width,
									   uint32_t height)
{
	struct pursuit_plane *plane = &layout->header.planes[layout->header.plane_count++];

	plane->role = role;
	plane->format = format;
	plane->storage = PURSUIT_STORAGE_MEMORY;
	plane->width = width;
	plane->height = height;
	plane->offset = layout->slot_bytes;
	plane->stride = align_up((uint64_t)width * pursuit_format_bytes(format), PURSUIT_PLANE_ALIGNMENT);
	plane->size = plane->stride * height;
	layout->slot_bytes = align_up(plane->offset + plane->size, PURSUIT_PLANE_ALIGNMENT);
	return plane;
}

static struct pursuit_transfer color_transfer(const struct pursuit_stream_params *params)
{
	struct pursuit_transfer transfer = {.curve = (uint32_t)params->color_curve};

	if (params->color_curve == PURSUIT_CURVE_DEFAULT) {
		transfer.curve = params->color_format == PURSUIT_COLOR_RGBA16F ? PURSUIT_CURVE_LINEAR : PURSUIT_CURVE_SRGB;
	}
	if (transfer.curve == PURSUIT_CURVE_GAMMA) {
		transfer.gamma = params->color_gamma;
	}
	return transfer;
}

static void add_planes(struct shim_layout *layout, const struct pursuit_stream_params *params)
{
	uint32_t width = params->geometry_width ? params->geometry_width : params->width;
	uint32_t height = params->geometry_height ? params->geometry_height : params->height;
	uint32_t color = params->color_format ? (uint32_t)params->color_format : PURSUIT_FORMAT_BGRA8;
	struct pursuit_transfer transfer = color_transfer(params);

	add_plane(layout, PURSUIT_ROLE_COLOR, color, params->width, params->height)->transfer = transfer;
	if (params->depth_format) {
		add_plane(layout, PURSUIT_ROLE_DEPTH, (uint32_t)params->depth_format, width, height);
		layout->header.depth_kind = (uint32_t)params->depth_kind + PURSUIT_DEPTH_DEVICE;
		layout->header.near_distance = params->near_distance;
		layout->header.far_distance = params->far_distance;
	}
	if (params->motion_format) {
		add_plane(layout, PURSUIT_ROLE_MOTION, (uint32_t)params->motion_format, width, height);
		layout->header.motion_kind = (uint32_t)params->motion_kind + PURSUIT_MOTION_BACKWARD;
	}
	if (params->ui_format) {
		/* Eight bits of linear code values are too few for a UI: beside linear colour it is sRGB. */
		if (transfer.curve == PURSUIT_CURVE_LINEAR) {
			transfer.curve = PURSUIT_CURVE_SRGB;
		}
		add_plane(layout, PURSUIT_ROLE_UI, (uint32_t)params->ui_format, params->width, params->height)->transfer =
			transfer;
	}
	if (params->object_id_format) {
		add_plane(layout, PURSUIT_ROLE_OBJECT_ID, (uint32_t)params->object_id_format, width, height);
	}
}

bool shim_layout_init(struct shim_layout *layout, const struct pursuit_stream_params *params)
{
	memset(layout, 0, sizeof(*layout));
	if (!size_is_valid(params) || !color_is_valid(params) || !depth_is_valid(params) || !others_are_valid(params)) {
		return false;
	}
	layout->slot_count = params->slot_count ? params->slot_count : DEFAULT_SLOTS;
	add_planes(layout, params);
	layout->slot_bytes = align_up(layout->slot_bytes, PAGE_BYTES);
	return layout->slot_bytes <= PURSUIT_MAX_FRAME_BYTES;
}

const struct pursuit_plane *shim_layout_plane(const struct shim_layout *layout, uint32_t role)
{
	for (uint32_t i = 0; i < layout->header.plane_count; i++) {
		if (layout->header.planes[i].role == role) {
			return &layout->header.planes[i];
		}
	}
	return NULL;
}

static struct pursuit_plane_memory plane_memory(const struct shim_layout *layout, uint8_t *slot, uint32_t role)
{
	const struct pursuit_plane *plane = shim_layout_plane(layout, role);
	struct pursuit_plane_memory memory = {0};

	if (plane) {
		memory.data = slot + plane->offset;
		memory.stride = plane->stride;
		memory.width = plane->width;
		memory.height = plane->height;
	}
	return memory;
}

void shim_layout_place(const struct shim_layout *layout, uint8_t *slot, struct pursuit_frame *frame)
{
	memset(frame, 0, sizeof(*frame));
	frame->color = plane_memory(layout, slot, PURSUIT_ROLE_COLOR);
	frame->depth = plane_memory(layout, slot, PURSUIT_ROLE_DEPTH);
	frame->motion = plane_memory(layout, slot, PURSUIT_ROLE_MOTION);
	frame->ui = plane_memory(layout, slot, PURSUIT_ROLE_UI);
	frame->object_id = plane_memory(layout, slot, PURSUIT_ROLE_OBJECT_ID);
}
