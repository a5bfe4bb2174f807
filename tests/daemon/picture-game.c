/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/daemon/picture-game.h"

#include <string.h>

#include "tests/daemon/fixture.h"

uint32_t picture_game_pattern(uint32_t x, uint32_t y)
{
	return (x * 7 + y * 31) * 2654435761u >> 8;
}

void picture_game_open(struct picture_game *game, const char *socket)
{
	const struct pursuit_stream_params params = {.width = game->width,
												 .height = game->height,
												 .depth_format = PURSUIT_DEPTH_FLOAT32,
												 .motion_format = PURSUIT_MOTION_FLOAT32,
												 .socket_path = socket,
												 .name = "test game"};
	game->stream = pursuit_open(&params);
}

void picture_game_play(struct picture_game *game)
{
	struct pursuit_frame *frame = pursuit_acquire(game->stream);
	for (uint32_t y = 0; frame && y < game->height; y++) {
		uint32_t *color = (uint32_t *)(void *)(frame->color.data + y * frame->color.stride);
		for (uint32_t x = 0; x < game->width; x++)
			color[x] = 0xff000000u | game->color_at(x, y);
		memset(frame->depth.data + y * frame->depth.stride, 0, (size_t)game->width * 4);
		memset(frame->motion.data + y * frame->motion.stride, 0, (size_t)game->width * 8);
	}
	if (frame)
		pursuit_submit(game->stream, frame);
	sleep_ms(25);
}

bool picture_game_play_until(struct picture_game *game, struct xvfb *xvfb, Window window, uint32_t x, uint32_t y,
							 uint32_t color, bool equal)
{
	for (int i = 0; i < PICTURE_GAME_PATIENCE; i++) {
		if ((xvfb_pixel(xvfb, window, x, y) == color) == equal)
			return true;
		picture_game_play(game);
	}
	return false;
}
