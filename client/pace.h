/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * When to begin the next frame, from the daemon's hint (proto/shm.h) and from
 * what the last frames took. Pure: time is passed in. The daemon may write any
 * nonsense at any moment.
 */
#ifndef PURSUIT_CLIENT_PACE_H
#define PURSUIT_CLIENT_PACE_H

#include <stdint.h>

#include "proto/shm.h"

#define SHIM_PACE_FRAMES 16u /* that can be under way, in read-backs say */
#define SHIM_PACE_RUNS 8u

/* Zeroed: nothing known. */
struct shim_pace {
	struct {
		uint64_t frame_id, begun_ns;
	} begun[SHIM_PACE_FRAMES];
	uint64_t work_ns[SHIM_PACE_RUNS]; /* from beginning to publishing, of the last frames */
	uint32_t count;
};

/* The frame that will get this number begins. */
void shim_pace_begin(struct shim_pace *pace, uint64_t frame_id, uint64_t now_ns);

/* It is published; what it took counts if its beginning is known. */
void shim_pace_publish(struct shim_pace *pace, uint64_t frame_id, uint64_t now_ns);

/*
 * When frame `frame_id` should begin so that it is published at the moment that the hint asks for; may be over. 0:
 * there is no hint, it is older than a second, or further ahead than a quarter of a second, so not to be believed.
 */
uint64_t shim_pace_start(const struct shim_pace *pace, const struct pursuit_shm_control *control, uint64_t frame_id,
						 uint64_t now_ns);

#endif
