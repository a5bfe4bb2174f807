/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A game whose picture stands still, some 40 times a second, for tests that look at a window's pixels. */
#ifndef PURSUIT_TESTS_PICTURE_GAME_H
#define PURSUIT_TESTS_PICTURE_GAME_H

#include <stdbool.h>
#include <stdint.h>

#include "client/pursuit.h"
#include "tests/daemon/xvfb.h"

#define PICTURE_GAME_PATIENCE 2400 /* frames: 60 s */

struct picture_game {
	uint32_t width, height;
	uint32_t (*color_at)(uint32_t x, uint32_t y); /* 0xrrggbb */
	struct pursuit_stream *stream;
};

/* A picture in which no two neighbours are alike. */
uint32_t picture_game_pattern(uint32_t x, uint32_t y);

/* Opens the stream; the caller closes it. */
void picture_game_open(struct picture_game *game, const char *socket);
/* One frame, without motion, and a sleep of 25 ms. */
void picture_game_play(struct picture_game *game);
/* Until a pixel of the window has this colour, or (not `equal`) another one. False: it does not come. */
bool picture_game_play_until(struct picture_game *game, struct xvfb *xvfb, Window window, uint32_t x, uint32_t y,
							 uint32_t color, bool equal);

#endif
