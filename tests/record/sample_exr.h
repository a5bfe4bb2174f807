/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Writes small OpenEXR files for the tests of the reader. */
#ifndef PURSUIT_TESTS_SAMPLE_EXR_H
#define PURSUIT_TESTS_SAMPLE_EXR_H

#include <stdbool.h>
#include <stdint.h>

struct sample_exr_channel {
	const char *name; /* in alphabetical order */
	int type;         /* exr_pixel_type_t: 0 uint, 1 half, 2 float */
	const void *data; /* rows without gaps, in that type */
};

struct sample_exr {
	uint32_t width, height;                 /* of the data */
	int32_t x, y;                           /* where the data begins */
	uint32_t display_width, display_height; /* from 0,0; 0: the data window */
	int compression;                        /* exr_compression_t: 0 none, 2 zips, 3 zip, 4 piz */
	uint32_t tile;                          /* side of a tile, 0: scanlines */
	const struct sample_exr_channel *channels;
	unsigned channel_count;
};

bool sample_exr_write(const char *path, const struct sample_exr *exr);

#endif
