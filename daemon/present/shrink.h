/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Makes pictures smaller on the CPU: a pixel gets the mean light of the area that it covers, so that fine patterns keep
 * their brightness and nothing flickers. Light is sRGB's to 0.003, which no mixture of two pixels tells by more than
 * three code values; areas of one colour keep it exactly. One thread at a time.
 */
#ifndef PURSUIT_SHRINK_H
#define PURSUIT_SHRINK_H

#include <stddef.h>
#include <stdint.h>

struct shrink;

/* Pixels; none of the targets is 0 or larger than where it comes from. NULL: no memory. */
struct shrink *shrink_create(uint32_t width, uint32_t height, uint32_t to_width, uint32_t to_height);
/* NULL accepted. */
void shrink_destroy(struct shrink **shrink);

/* BGRX8, rows top to bottom, strides in bytes; the X of the target is 255. */
void shrink_run(struct shrink *shrink, const uint8_t *from, size_t from_stride, uint8_t *to, size_t to_stride);

#endif
