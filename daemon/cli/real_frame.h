/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Real frames out of a recording of which only each K-th is real: motion that
 * spans fewer recorded frames is composed over the K, each step looked up where
 * the one before it leads. Where a frame of the chain is missing (the recording
 * begins, a frame is damaged) the steps that there are count, with the interval
 * that they span, and the engine goes on from there linearly.
 */
#ifndef PURSUIT_CLI_REAL_FRAME_H
#define PURSUIT_CLI_REAL_FRAME_H

#include <stdint.h>

#include "schedule.h"

/* A recorded frame of which only header and motion are kept. */
struct motion_step {
	struct frame frame;
	uint8_t *bytes; /* owned */
	size_t capacity;
};

struct real_frames {
	struct recording_reader *reader; /* its slots 0 and 1 are used */
	const struct recorded_frames *frames;
	struct motion_step *steps; /* all but the first, which is the real frame itself; owned */
	uint32_t step_capacity;
	float *motion; /* two a pixel, composed; owned */
	size_t motion_capacity;
};

/* The real frame of a beginning, ready for engine_begin(), valid until the next call. 0 or a negative errno with a
 * sentence. */
int real_frames_load(struct real_frames *real, const struct beginning *beginning, struct frame *frame,
					 struct error *error);
void real_frames_finish(struct real_frames *real);

#endif
