/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A small game of some 60 frames a second, for tests in which something ends or stands still beside it. */
#ifndef PURSUIT_TESTS_FAULT_GAME_H
#define PURSUIT_TESTS_FAULT_GAME_H

#include <stdbool.h>
#include <stdint.h>

#include "client/pursuit.h"

#define GAME_FRAME_MS 16u

/* A stream of 64x48 pixels to the daemon at this socket; the caller closes it. NULL: there is none. */
struct pursuit_stream *game_open(const char *socket);
bool game_is_attached(struct pursuit_stream *stream);
/*
 * One frame, and a sleep of GAME_FRAME_MS; the time that the shim took of it if it waited, ns; 0: it did not, however
 * long the machine let it stand.
 */
uint64_t game_play_frame(struct pursuit_stream *stream);

#endif
