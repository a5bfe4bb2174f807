/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/overlay.h"

#include <stdbool.h>
#include <string.h>

#include "daemon/letters.h"

#define BLACK 0xff000000u
#define PAPER 0xff181818u
#define INK 0xfff0f0f0u
#define LINE 0xff808080u
#define MARGIN 4u /* in dots, between box and letters, and between box and picture */
#define ADVANCE (LETTER_WIDTH + 1)
#define LINE_HEIGHT (LETTER_HEIGHT + 2)

uint32_t overlay_scale(const struct overlay *overlay)
{
	return overlay->height < 540 || overlay->width < 800 ? 1 : overlay->height < 1100 ? 2 : 3;
}

static void fill(const struct overlay *overlay, uint32_t x, uint32_t y, uint32_t width, uint32_t height, uint32_t color)
{
	if (x >= overlay->width || y >= overlay->height)
		return;
	if (width > overlay->width - x)
		width = overlay->width - x;
	if (height > overlay->height - y)
		height = overlay->height - y;
	for (uint32_t row = y; row < y + height; row++) {
		uint8_t *to = overlay->data + (size_t)row * overlay->stride + (size_t)x * 4;
		for (uint32_t i = 0; i < width; i++)
			memcpy(to + (size_t)i * 4, &color, sizeof(color));
	}
}

void overlay_blacken(const struct overlay *overlay)
{
	fill(overlay, 0, 0, overlay->width, overlay->height, BLACK);
}

static void draw_letter(const struct overlay *overlay, uint32_t x, uint32_t y, uint32_t scale, char letter)
{
	const bool known = letter >= LETTER_FIRST && letter <= LETTER_LAST;
	const uint8_t *columns = letters[(known ? letter : '?') - LETTER_FIRST];
	for (uint32_t column = 0; column < LETTER_WIDTH; column++)
		for (uint32_t row = 0; row < LETTER_HEIGHT; row++)
			if (columns[column] >> row & 1)
				fill(overlay, x + column * scale, y + row * scale, scale, scale, INK);
}

static void measure(const char *text, uint32_t *columns, uint32_t *lines)
{
	*columns = 0;
	*lines = 0;
	while (*text) {
		const size_t length = strcspn(text, "\n");
		if (length > *columns)
			*columns = (uint32_t)length;
		++*lines;
		text += length + (text[length] == '\n');
	}
}

void overlay_text(const struct overlay *overlay, enum overlay_place place, const char *text)
{
	const uint32_t scale = overlay_scale(overlay), margin = MARGIN * scale;
	uint32_t columns, lines;
	measure(text, &columns, &lines);
	const uint32_t width = columns * ADVANCE * scale + 2 * margin, height = lines * LINE_HEIGHT * scale + 2 * margin;
	const uint32_t right = overlay->width > width + margin ? overlay->width - width - margin : 0;
	const uint32_t bottom = overlay->height > height + margin ? overlay->height - height - margin : 0;
	const bool at_right = place == OVERLAY_TOP_RIGHT || place == OVERLAY_BOTTOM_RIGHT;
	const bool at_bottom = place == OVERLAY_BOTTOM_LEFT || place == OVERLAY_BOTTOM_RIGHT;
	const uint32_t x = place == OVERLAY_CENTER ? right / 2 : at_right ? right : margin;
	const uint32_t y = place == OVERLAY_CENTER ? bottom / 2 : at_bottom ? bottom : margin;
	if (lines == 0)
		return;
	fill(overlay, x, y, width, height, PAPER);
	uint32_t column = 0, line = 0;
	for (; *text; text++) {
		if (*text == '\n') {
			column = 0;
			line++;
			continue;
		}
		draw_letter(overlay, x + margin + column++ * ADVANCE * scale, y + margin + line * LINE_HEIGHT * scale, scale,
					*text);
	}
}

void overlay_divide(const struct overlay *overlay, uint32_t x)
{
	fill(overlay, x, 0, overlay_scale(overlay), overlay->height, LINE);
}
