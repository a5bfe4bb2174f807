/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/fuzz/good-frame.h"

#include <string.h>

static void add_plane(struct pursuit_frame_header *header, uint32_t role, uint32_t format)
{
	const uint32_t i = header->plane_count++;
	header->planes[i] = (struct pursuit_plane){
		.role = role,
		.format = format,
		.storage = PURSUIT_STORAGE_MEMORY,
		.width = GOOD_WIDTH,
		.height = GOOD_HEIGHT,
		.offset = (uint64_t)i * GOOD_PLANE_BYTES,
		.stride = GOOD_WIDTH * 8,
		.size = GOOD_PLANE_BYTES,
	};
}

void good_frame(struct pursuit_frame_header *header)
{
	memset(header, 0, sizeof(*header));
	header->frame_id = 1;
	header->time_ns = 1000000000;
	header->submit_ns = 1000000000;
	header->real_interval_ns = 16666667;
	header->motion_kind = PURSUIT_MOTION_BACKWARD;
	header->depth_kind = PURSUIT_DEPTH_DEVICE;
	add_plane(header, PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_BGRA8);
	header->planes[0].transfer.curve = PURSUIT_CURVE_SRGB;
	add_plane(header, PURSUIT_ROLE_DEPTH, PURSUIT_FORMAT_DEPTH32F);
	add_plane(header, PURSUIT_ROLE_MOTION, PURSUIT_FORMAT_RG32F);
	add_plane(header, PURSUIT_ROLE_UI, PURSUIT_FORMAT_BGRA8);
	header->planes[3].transfer.curve = PURSUIT_CURVE_SRGB;
	add_plane(header, PURSUIT_ROLE_OBJECT_ID, PURSUIT_FORMAT_R32UI);
	add_plane(header, 40, 200);
}

void good_frame_patch(struct pursuit_frame_header *header, struct fuzz_input *input, unsigned most)
{
	for (unsigned i = 0; i < most && input->size > 0; i++) {
		const uint8_t where = fuzz_u8(input);
		const uint64_t value = fuzz_number(input);
		/* All fields are 4 or 8 bytes at a multiple of 4; those of the planes are most. */
		const size_t offset = (size_t)where * 4 % (sizeof(*header) - 8);
		memcpy((char *)header + offset, &value, where & 1 || offset >= 200 ? 4 : 8);
	}
}
