/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What a stream's parameters mean in bytes: the frame header that all frames
 * of the stream start from, and where each plane lies in a slot. Pure.
 */
#ifndef PURSUIT_CLIENT_LAYOUT_H
#define PURSUIT_CLIENT_LAYOUT_H

#include <stdbool.h>
#include <stdint.h>

#include "client/pursuit.h"
#include "proto/frame.h"

struct shim_layout {
	uint32_t slot_count;                /* PURSUIT_MIN_SLOTS to PURSUIT_MAX_SLOTS */
	uint64_t slot_bytes;                /* a multiple of 4096, at most PURSUIT_MAX_FRAME_BYTES */
	struct pursuit_frame_header header; /* planes, kinds and distances set, the rest 0 */
};

/* False if a parameter is out of range. Planes are in the order colour, depth, motion, UI, object id. */
bool shim_layout_init(struct shim_layout *layout, const struct pursuit_stream_params *params);

/* The plane with this role, or NULL. */
const struct pursuit_plane *shim_layout_plane(const struct shim_layout *layout, uint32_t role);

/* Zeroes *frame and points its planes into the slot that starts at `slot`. */
void shim_layout_place(const struct shim_layout *layout, uint8_t *slot, struct pursuit_frame *frame);

#endif
