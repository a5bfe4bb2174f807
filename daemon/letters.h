/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Letters of 5 x 7 pixels, and one more below the line, for text on pictures:
 * ASCII 32 to 126, five columns each, the lowest bit on top.
 */
#ifndef PURSUIT_LETTERS_H
#define PURSUIT_LETTERS_H

#include <stddef.h>
#include <stdint.h>

#define LETTER_WIDTH 5u
#define LETTER_HEIGHT 8u
#define LETTER_ADVANCE (LETTER_WIDTH + 1u)

/* What they are drawn on: BGRA8, rows top to bottom. */
struct letters_picture {
	uint8_t *data;
	size_t stride;
	uint32_t width, height;
};

/* A filled rectangle, 0xaarrggbb. Only written, never read; clipped. */
void letters_box(const struct letters_picture *picture, uint32_t x, uint32_t y, uint32_t width, uint32_t height,
				 uint32_t color);

/*
 * One line of text, up to its end or '\n', with nothing behind it: its upper left corner, pixels of a dot. What is not
 * printable is shown as '?'.
 */
void letters_line(const struct letters_picture *picture, uint32_t x, uint32_t y, uint32_t scale, uint32_t color,
				  const char *text);

#endif
