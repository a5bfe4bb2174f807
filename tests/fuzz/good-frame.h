/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A small good frame to be spoilt: colour, depth, motion, UI, object id and a role of the future. */
#ifndef PURSUIT_TESTS_GOOD_FRAME_H
#define PURSUIT_TESTS_GOOD_FRAME_H

#include "proto/frame.h"
#include "tests/fuzz/fuzz.h"

#define GOOD_WIDTH 16u
#define GOOD_HEIGHT 4u
#define GOOD_PLANE_BYTES 512u
#define GOOD_FRAME_BYTES UINT64_C(4096)

void good_frame(struct pursuit_frame_header *header);

/* Writes numbers of the input over fields; at most so many. */
void good_frame_patch(struct pursuit_frame_header *header, struct fuzz_input *input, unsigned most);

#endif
