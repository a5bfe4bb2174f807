/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A real frame as the daemon sees it: a private copy of its header and where
 * the bytes of each plane are. Comes from shared memory (server), from a
 * recording (record/) or from a scene (cli/); the engine takes all alike.
 */
#ifndef PURSUIT_DAEMON_FRAME_H
#define PURSUIT_DAEMON_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/error.h"
#include "proto/frame.h"

struct frame {
	struct pursuit_frame_header header;        /* validated by frame_validate() */
	const uint8_t *planes[PURSUIT_MAX_PLANES]; /* first row of planes[i] of the header; borrowed */
	bool volatile_memory;                      /* another process may change the planes while they are read */
	uint64_t intake_ns;                        /* CLOCK_MONOTONIC, 0 unknown */
	/* The sequence that it belongs to: damage counts only against a frame of the same one. 0: damage is not used. */
	uint64_t stream;
};

/*
 * Checks every field of a header: counts, roles (at most one of each known
 * role; colour is mandatory), formats that fit their role, sizes, strides,
 * offsets and sizes within `planes_bytes` (no overflow; all planes together at
 * most PURSUIT_MAX_FRAME_BYTES, even where they share bytes), kinds, flags,
 * damage within the colour plane, reserved bytes, finite transfer, near < far. Values that are merely absurd (a
 * matrix that is not finite, a jitter beyond the picture, times and intervals
 * that ran backwards and wrapped) are mended to "unknown" in place, and so are
 * the kind of a plane that is not there and the planes beyond plane_count. A
 * motion plane with kind NONE or a depth plane with kind NONE is refused.
 * Colour and UI must have equal size. A plane of an unknown role may have an
 * unknown format: then only offset, stride and size are checked.
 *
 * 0, or -EINVAL with a sentence "frame 12: planes[1].stride is 7, must be ...";
 * *field (a static string, may be NULL) and *value (may be NULL; of a float its
 * 32 bits) name the culprit.
 */
int frame_validate(struct pursuit_frame_header *header, uint64_t planes_bytes, const char **field, uint64_t *value,
				   struct error *error);

/* Index of the plane with that role in the header, -1 if there is none. */
int frame_find_plane(const struct pursuit_frame_header *header, uint32_t role);

/*
 * Lays out packed planes in a header whose planes[].role, format, width and
 * height are set: fills storage, stride (rows aligned to 64 bytes), offset,
 * size. A plane of an unknown format keeps its stride and size. Returns the
 * bytes that all planes take together, 0 if a size, or all of them, is beyond its limit.
 */
uint64_t frame_layout(struct pursuit_frame_header *header);

#endif
