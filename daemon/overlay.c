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
#define LINE_HEIGHT (LETTER_HEIGHT + 2)

uint32_t overlay_scale(const struct overlay *overlay)
{
	return overlay->height < 540 || overlay->width < 800 ? 1 : overlay->height < 1100 ? 2 : 3;
}

static void fill(const struct overlay *overlay, uint32_t x, uint32_t y, uint32_t width, uint32_t height, uint32_t color)
{
	const struct letters_picture picture = {overlay->data, overlay->stride, overlay->width, overlay->height};
	letters_box(&picture, x, y, width, height, color);
}

void overlay_blacken(const struct overlay *overlay)
{
	fill(overlay, 0, 0, overlay->width, overlay->height, BLACK);
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
	const uint32_t width = columns * LETTER_ADVANCE * scale + 2 * margin,
				   height = lines * LINE_HEIGHT * scale + 2 * margin;
	const uint32_t right = overlay->width > width + margin ? overlay->width - width - margin : 0;
	const uint32_t bottom = overlay->height > height + margin ? overlay->height - height - margin : 0;
	const bool at_right = place == OVERLAY_TOP_RIGHT || place == OVERLAY_BOTTOM_RIGHT;
	const bool at_bottom = place == OVERLAY_BOTTOM_LEFT || place == OVERLAY_BOTTOM_RIGHT;
	const uint32_t x = place == OVERLAY_CENTER ? right / 2 : at_right ? right : margin;
	const uint32_t y = place == OVERLAY_CENTER ? bottom / 2 : at_bottom ? bottom : margin;
	if (lines == 0)
		return;
	const struct letters_picture picture = {overlay->data, overlay->stride, overlay->width, overlay->height};
	letters_box(&picture, x, y, width, height, PAPER);
	for (uint32_t line = 0; line < lines; line++) {
		letters_line(&picture, x + margin, y + margin + line * LINE_HEIGHT * scale, scale, INK, text);
		text += strcspn(text, "\n");
		text += *text == '\n';
	}
}

void overlay_divide(const struct overlay *overlay, uint32_t x)
{
	fill(overlay, x, 0, overlay_scale(overlay), overlay->height, LINE);
}
