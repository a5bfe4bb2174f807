/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/warm_up.h"

#define SIDE 64

struct planes {
	uint8_t color[SIDE][SIDE][4], ui[SIDE][SIDE][4];
	float depth[SIDE][SIDE], motion[SIDE][SIDE][2];
};

/* A square that comes forward and moves over what is behind it: a fold on one side, a tear on the other. */
static void draw(struct planes *planes)
{
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++) {
			bool inside = x >= 16 && x < 40 && y >= 16 && y < 48;
			planes->motion[y][x][0] = inside ? 14.0f : 0.0f;
			planes->depth[y][x] = inside ? 0.25f : 0.75f;
			planes->ui[y][x][3] = x < 8 ? 128 : 0;
		}
}

static void describe(struct frame *frame, const struct planes *planes)
{
	static const uint32_t kinds[][3] = {
		{PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_BGRA8, 4},
		{PURSUIT_ROLE_UI, PURSUIT_FORMAT_BGRA8, 4},
		{PURSUIT_ROLE_DEPTH, PURSUIT_FORMAT_DEPTH32F, 4},
		{PURSUIT_ROLE_MOTION, PURSUIT_FORMAT_RG32F, 8},
	};
	const void *const data[] = {planes->color, planes->ui, planes->depth, planes->motion};
	struct pursuit_frame_header *header = &frame->header;
	header->frame_id = 1;
	header->real_interval_ns = 25000000;
	header->motion_kind = PURSUIT_MOTION_BACKWARD;
	header->depth_kind = PURSUIT_DEPTH_DEVICE;
	header->plane_count = 4;
	for (int i = 0; i < 4; i++) {
		header->planes[i] = (struct pursuit_plane){
			.role = kinds[i][0],
			.format = kinds[i][1],
			.storage = PURSUIT_STORAGE_MEMORY,
			.width = SIDE,
			.height = SIDE,
			.stride = (uint64_t)kinds[i][2] * SIDE,
			.size = (uint64_t)kinds[i][2] * SIDE * SIDE,
			.transfer.curve = PURSUIT_CURVE_SRGB,
		};
		frame->planes[i] = data[i];
	}
}

static int show_all(struct engine *engine, const struct frame *frame, struct planes *planes, struct error *error)
{
	static const struct engine_request requests[] = {
		{ENGINE_SHOW_REAL, 0.0}, {ENGINE_SHOW_REAL, 0.2}, {ENGINE_SHOW_IN_BETWEEN, 0.5}};
	struct engine_begin_params begin = {.n = 3, .last_phase = -1.0};
	struct engine_image image = {&planes->color[0][0][0], 4 * SIDE};
	int result = engine_begin(engine, frame, &begin, error);
	for (size_t i = 0; i < sizeof(requests) / sizeof(requests[0]) && result == 0; i++)
		result = engine_render(engine, &requests[i], &image, error);
	return result;
}

int warm_up(struct engine *engine, struct error *error)
{
	struct frame frame = {0};
	struct planes planes = {0};
	draw(&planes);
	describe(&frame, &planes);
	return show_all(engine, &frame, &planes, error);
}
