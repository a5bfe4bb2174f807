/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Images in files: PNG, PFM and OpenEXR in, PNG and PFM out. Nothing that a
 * file says is believed before it is checked; errors name file, field, value.
 * Any thread, no state.
 */
#ifndef PURSUIT_IMAGE_H
#define PURSUIT_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/error.h"

/* What the caller wants out of a file, whatever its format. */
enum image_want {
	/*
	 * Colour: BGRA, 8 bit, sRGB code values, alpha as in the file (not
	 * premultiplied in PNG). Linear floats (PFM, OpenEXR) are clamped to 0
	 * to 1 and encoded; grey becomes R = G = B.
	 */
	IMAGE_BGRA,
	/*
	 * Numbers: floats. PNG codes are divided by `scale`. Of OpenEXR, channel
	 * 0 is R, else X, U, Y, Z, else the first in the list; channel 1 is the
	 * one that goes with it (G, Y, V), else the next in the list.
	 */
	IMAGE_VALUES
};

struct image {
	uint32_t width, height;
	uint32_t channels;  /* of `values`, 1 to 4, interleaved; 4 for `bgra` */
	float *values;      /* rows top to bottom, no gaps; NULL for IMAGE_BGRA */
	uint8_t *bgra;      /* rows top to bottom, no gaps; NULL for IMAGE_VALUES */
	float scale;        /* values x scale are the codes of the file: 255 or 65535 for PNG, else 1 */
	bool has_alpha;     /* of IMAGE_BGRA: the file has alpha */
	bool premultiplied; /* of IMAGE_BGRA: colour is multiplied by alpha already (OpenEXR) */
};

/*
 * Reads a file, its format known by its first bytes. Sides are at most
 * PURSUIT_MAX_SIZE, and the pixels at most `memory_limit` bytes (0: 1 GiB).
 * 0 or a negative errno with a sentence; image_finish() is needed only after 0.
 */
int image_read(const char *path, enum image_want want, uint64_t memory_limit, struct image *image, struct error *error);
void image_finish(struct image *image);

/* Linear light to an sRGB code, clamped; NaN gives 0. */
uint8_t image_encode_srgb(float light);

/* Writes BGRA8 as PNG, RGB or RGBA, quickly rather than small. */
int image_write_png(const char *path, const uint8_t *bgra, size_t stride, uint32_t width, uint32_t height, bool alpha,
					struct error *error);

/*
 * The same as small as it gets, for files that travel: packed BGRA8 as RGB.
 * `differences`: most of it is 0, and what is not is like noise.
 */
int image_write_png_small(const char *path, const uint8_t *bgra, uint32_t width, uint32_t height, bool differences,
						  struct error *error);

/* Writes packed floats as PFM: one channel as Pf, two (the third becomes 0) or three as PF. */
int image_write_pfm(const char *path, const float *values, uint32_t width, uint32_t height, uint32_t channels,
					struct error *error);

#endif
