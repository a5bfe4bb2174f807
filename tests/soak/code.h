/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Pictures that say whose they are: the first two pixels hold the numbers of
 * client and frame, every other one follows from these and its place. A picture
 * made of two frames, or a piece of memory that is none, is told at once.
 */
#ifndef PURSUIT_TESTS_CODE_H
#define PURSUIT_TESTS_CODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Fills BGRA8 or, with `rgba`, RGBA8; numbers below 2^24. At least 2 pixels wide. */
void code_write(uint8_t *pixels, size_t stride, uint32_t width, uint32_t height, bool rgba, uint32_t client,
				uint32_t frame);

/* Is this BGRA8 exactly one picture? Its numbers, of the first pixels, in any case. Alpha does not count. */
bool code_read(const uint8_t *pixels, size_t stride, uint32_t width, uint32_t height, uint32_t *client,
			   uint32_t *frame);

#endif
