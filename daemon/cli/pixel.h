/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Rows of what a scene gives (BGRA8, float) written in the formats of planes, and depth read back. */
#ifndef PURSUIT_CLI_PIXEL_H
#define PURSUIT_CLI_PIXEL_H

#include <stdint.h>

/* BGRA8 sRGB code values to PURSUIT_FORMAT_* of colour. RGB10A2 keeps the sRGB curve, RGBA16F is linear light. */
void pixel_write_color(uint32_t format, const uint8_t *bgra, uint32_t width, uint8_t *row);

/* Device depth in [0, 1]. */
void pixel_write_depth(uint32_t format, const float *depth, uint32_t width, uint8_t *row);

/* The other way: any format of depth to 0..1 (DEPTH32F as it is). */
void pixel_read_depth(uint32_t format, const uint8_t *row, uint32_t width, float *depth);

/* Two floats a pixel. */
void pixel_write_motion(uint32_t format, const float *motion, uint32_t width, uint8_t *row);

/* Means over factor x factor pixels of a packed picture of (width x factor) x (height x factor), all four channels. */
void pixel_shrink(const uint8_t *fine, uint32_t factor, uint32_t width, uint32_t height, uint8_t *bgra);

/* Puts a premultiplied layer over a row, in code values, and makes it opaque (docs/method.md, 7). */
void pixel_composite(uint8_t *bgra, const uint8_t *ui, uint32_t width);

#endif
