/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Copying one row of pixels out of a pixel buffer into a plane, converting on
 * the way. Pure. Source and destination do not overlap; sources are aligned to
 * their component, destinations as planes are.
 */
#ifndef PURSUIT_CLIENT_GL_ROWS_H
#define PURSUIT_CLIENT_GL_ROWS_H

#include <stdint.h>

/* What a converter may need to know besides the pixels. */
struct shim_row_options {
	uint32_t channels;    /* of the source */
	uint32_t pixel_bytes; /* of source and destination, where they are equal */
	uint32_t negate_y;    /* motion: 1 turns the sign of y */
};

typedef void (*shim_row)(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);

/* The same pixels. */
void shim_row_copy(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);
/* RGBA8 to BGRA8. */
void shim_row_swap(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);
/* Four floats to four halves, rounded to nearest even. */
void shim_row_color_half(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);
/* First of `channels` floats to float, or to 16 or 24 bits (0 to 1 clamped, rounded, NaN to 0). */
void shim_row_depth_float(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);
void shim_row_depth16(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);
void shim_row_depth24(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);
/* Two halves to two halves; first two of `channels` floats to two floats, or to two halves. */
void shim_row_motion_half(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);
void shim_row_motion_float(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);
void shim_row_motion_to_half(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);
/* First of `channels` 32-bit integers to 8, 16 or 32 bits; larger ones are clamped. */
void shim_row_id8(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);
void shim_row_id16(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);
void shim_row_id32(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options);

/* Float to IEEE half, to nearest even; overflow to infinity, NaN stays NaN. */
uint16_t shim_half(float value);

#endif
