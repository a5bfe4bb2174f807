/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Rows of what a scene gives (BGRA8, float) written in the formats of planes. */
#ifndef PURSUIT_CLI_PIXEL_H
#define PURSUIT_CLI_PIXEL_H

#include <stdint.h>

/* BGRA8 sRGB code values to PURSUIT_FORMAT_* of colour. RGB10A2 keeps the sRGB curve, RGBA16F is linear light. */
void pixel_write_color(uint32_t format, const uint8_t *bgra, uint32_t width, uint8_t *row);

/* Device depth in [0, 1]. */
void pixel_write_depth(uint32_t format, const float *depth, uint32_t width, uint8_t *row);

/* Two floats a pixel. */
void pixel_write_motion(uint32_t format, const float *motion, uint32_t width, uint8_t *row);

/* Puts a premultiplied layer over a row, in code values, and makes it opaque (docs/method.md, 7). */
void pixel_composite(uint8_t *bgra, const uint8_t *ui, uint32_t width);

#endif
