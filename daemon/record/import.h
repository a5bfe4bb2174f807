/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Makes a recording out of numbered images. Colour becomes BGRA8 with the sRGB
 * curve, depth DEPTH32F, motion RG16F where that is exact and RG32F elsewhere,
 * UI premultiplied BGRA8, object ids R32UI.
 *
 * Times: frame i (0 up) depicts 1 s + i / fps. Numbers: frame i has frame_id
 * i + 1, and the number of its image is number_offset + frame_id - 1; number_offset is a
 * line of INFO.
 */
#ifndef PURSUIT_IMPORT_H
#define PURSUIT_IMPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/error.h"

/* Frames a second, exactly. */
struct rate {
	uint64_t frames;
	uint64_t seconds;
};

struct import_params {
	const char *path; /* of the recording; removed again if the images cannot be read */
	/* Patterns as in pattern.h; colour is needed, the others may be NULL. */
	const char *color, *depth, *motion, *ui, *object_id;
	struct rate rate;
	bool has_range; /* first and last are given; else from the colour files that there are */
	uint64_t first, last;
	uint32_t motion_kind;              /* PURSUIT_MOTION_*, 0: backward */
	uint32_t depth_kind;               /* PURSUIT_DEPTH_*, 0: device */
	bool motion_in_ndc;                /* -1 to 1 across the picture, y up; else pixels */
	uint32_t motion_span;              /* recorded frames that motion spans, 0: 1 */
	float near_distance, far_distance; /* 0: unknown */
};

struct import_summary {
	uint64_t first, last, frames, truth_only, bytes;
	uint64_t half_motion; /* frames whose motion is stored as half */
	uint32_t width, height;
};

/*
 * 0 or a negative errno with a sentence. A regular file is written as PATH.part and takes its place when it is whole:
 * one that was there is kept if this fails.
 */
int import_run(const struct import_params *params, struct import_summary *summary, struct error *error);

#endif
