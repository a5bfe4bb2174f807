/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Parameters of a stream: what is refused, and what the others become in a frame header. */

#include "client/layout.h"
#include "proto/shm.h"
#include "tests/test.h"

static struct pursuit_stream_params full_params(void)
{
	return (struct pursuit_stream_params){
		.width = 641,
		.height = 359,
		.color_format = PURSUIT_COLOR_RGBA16F,
		.depth_format = PURSUIT_DEPTH_UNORM24,
		.depth_kind = PURSUIT_DEPTH_IS_REVERSED,
		.near_distance = 0.1f,
		.far_distance = INFINITY,
		.motion_format = PURSUIT_MOTION_FLOAT32,
		.motion_kind = PURSUIT_MOTION_IS_FORWARD,
		.geometry_width = 321,
		.ui_format = PURSUIT_UI_RGBA8,
		.object_id_format = PURSUIT_OBJECT_ID_UINT8,
	};
}

static bool accepts(const struct pursuit_stream_params *params)
{
	struct shim_layout layout;
	return shim_layout_init(&layout, params);
}

#define REFUSED_IF(change)                                   \
	do {                                                     \
		struct pursuit_stream_params params = full_params(); \
		CHECK(accepts(&params));                             \
		change;                                              \
		CHECK(!accepts(&params));                            \
	} while (0)

static void test_refused(void)
{
	REFUSED_IF(params.width = 0);
	REFUSED_IF(params.height = 0);
	REFUSED_IF(params.width = 16385);
	REFUSED_IF(params.height = UINT32_MAX);
	REFUSED_IF(params.geometry_width = 16385);
	REFUSED_IF(params.geometry_height = 16385);
	REFUSED_IF(params.color_format = (enum pursuit_color_format)5);
	REFUSED_IF(params.color_curve = (enum pursuit_color_curve)4);
	REFUSED_IF(params.color_curve = PURSUIT_CURVE_IS_GAMMA);
	REFUSED_IF((params.color_curve = PURSUIT_CURVE_IS_GAMMA, params.color_gamma = 0.99f));
	REFUSED_IF((params.color_curve = PURSUIT_CURVE_IS_GAMMA, params.color_gamma = 5.1f));
	REFUSED_IF((params.color_curve = PURSUIT_CURVE_IS_GAMMA, params.color_gamma = NAN));
	REFUSED_IF(params.depth_format = (enum pursuit_depth_format)19);
	REFUSED_IF(params.depth_kind = (enum pursuit_depth_kind)3);
	REFUSED_IF(params.depth_kind = PURSUIT_DEPTH_IS_LINEAR);
	REFUSED_IF((params.depth_kind = PURSUIT_DEPTH_IS_LINEAR, params.depth_format = PURSUIT_DEPTH_FLOAT32,
				params.near_distance = 0.0f));
	REFUSED_IF(params.near_distance = -1.0f);
	REFUSED_IF(params.near_distance = NAN);
	REFUSED_IF(params.near_distance = INFINITY);
	REFUSED_IF(params.far_distance = 0.05f);
	REFUSED_IF(params.far_distance = NAN);
	REFUSED_IF(params.far_distance = -1.0f);
	REFUSED_IF(params.motion_format = (enum pursuit_motion_format)34);
	REFUSED_IF(params.motion_kind = (enum pursuit_motion_kind)2);
	REFUSED_IF(params.ui_format = (enum pursuit_ui_format)3);
	REFUSED_IF(params.object_id_format = (enum pursuit_object_id_format)51);
	REFUSED_IF(params.slot_count = 2);
	REFUSED_IF(params.slot_count = 9);
	/* 16384 x 16384 x (8 + 4) bytes and more. */
	REFUSED_IF((params.width = 16384, params.height = 16384));
}

static void test_planes(void)
{
	const uint32_t roles[] = {PURSUIT_ROLE_COLOR, PURSUIT_ROLE_DEPTH, PURSUIT_ROLE_MOTION, PURSUIT_ROLE_UI,
							  PURSUIT_ROLE_OBJECT_ID};
	struct pursuit_stream_params params = full_params();
	struct shim_layout layout;
	uint64_t end = 0;

	CHECK(shim_layout_init(&layout, &params));
	CHECK_INT(layout.slot_count, 4);
	CHECK_INT(layout.slot_bytes % 4096, 0);
	CHECK_INT(layout.header.plane_count, 5);
	for (uint32_t i = 0; i < 5; i++) {
		const struct pursuit_plane *plane = &layout.header.planes[i];
		bool geometry = i == 1 || i == 2 || i == 4;
		uint64_t row = (uint64_t)plane->width * pursuit_format_bytes(plane->format);
		CHECK_INT(plane->role, roles[i]);
		CHECK_INT(plane->storage, PURSUIT_STORAGE_MEMORY);
		CHECK_INT(plane->width, geometry ? 321 : 641);
		CHECK_INT(plane->height, 359);
		CHECK_INT(plane->offset % PURSUIT_PLANE_ALIGNMENT, 0);
		CHECK_INT(plane->stride % pursuit_format_bytes(plane->format), 0);
		CHECK(plane->stride >= row && plane->offset >= end);
		CHECK(plane->size >= plane->stride * (plane->height - 1) + row);
		end = plane->offset + plane->size;
	}
	CHECK(end <= layout.slot_bytes);
	CHECK_INT(layout.header.depth_kind, PURSUIT_DEPTH_DEVICE_REVERSED);
	CHECK_INT(layout.header.motion_kind, PURSUIT_MOTION_FORWARD);
	CHECK(isinf(layout.header.far_distance));
	CHECK_INT(layout.header.planes[0].transfer.curve, PURSUIT_CURVE_LINEAR);
	CHECK_INT(layout.header.planes[3].transfer.curve, PURSUIT_CURVE_SRGB);
	CHECK_INT(layout.header.planes[1].transfer.curve, 0);
}

static void test_defaults(void)
{
	struct pursuit_stream_params params = {.width = 1, .height = 1, .color_gamma = 2.2f, .near_distance = 1.0f};
	struct shim_layout layout;

	CHECK(shim_layout_init(&layout, &params));
	CHECK_INT(layout.header.plane_count, 1);
	CHECK_INT(layout.header.planes[0].format, PURSUIT_FORMAT_BGRA8);
	CHECK_INT(layout.header.planes[0].transfer.curve, PURSUIT_CURVE_SRGB);
	CHECK(layout.header.planes[0].transfer.gamma == 0.0f);
	CHECK(layout.header.near_distance == 0.0f);
	CHECK_INT(layout.header.depth_kind, PURSUIT_DEPTH_NONE);
	CHECK_INT(layout.header.motion_kind, PURSUIT_MOTION_NONE);
	CHECK(shim_layout_plane(&layout, PURSUIT_ROLE_DEPTH) == NULL);

	params.color_curve = PURSUIT_CURVE_IS_GAMMA;
	CHECK(shim_layout_init(&layout, &params));
	CHECK(layout.header.planes[0].transfer.gamma == 2.2f);
}

static void test_memory(void)
{
	struct pursuit_stream_params params = full_params();
	struct pursuit_frame frame;
	struct shim_layout layout;
	static uint8_t slot[8 << 20];

	memset(&frame, 0xff, sizeof(frame));
	CHECK(shim_layout_init(&layout, &params));
	CHECK(layout.slot_bytes <= sizeof(slot));
	shim_layout_place(&layout, slot, &frame);
	CHECK(frame.color.data == slot);
	CHECK_INT(frame.depth.width, 321);
	CHECK(frame.object_id.data + frame.object_id.stride * frame.object_id.height <= slot + layout.slot_bytes);
	CHECK_INT(frame.flags, 0);
	CHECK_INT(frame.time_ns, 0);
}

int main(void)
{
	RUN(test_refused);
	RUN(test_planes);
	RUN(test_defaults);
	RUN(test_memory);
	return test_result();
}
