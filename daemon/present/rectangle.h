/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Where a picture lies. */
#ifndef PURSUIT_RECTANGLE_H
#define PURSUIT_RECTANGLE_H

#include <stdint.h>

/* Pixels, from the upper left corner. */
struct rectangle {
	uint32_t x, y, width, height;
};

/*
 * Where a picture of this size goes on a display of that size: as large as it fits, its shape kept to the next whole
 * pixel, centred. All sizes at least 1.
 */
static inline struct rectangle rectangle_fit(uint32_t width, uint32_t height, uint32_t display_width,
											 uint32_t display_height)
{
	struct rectangle fit = {0, 0, display_width, display_height};
	if ((uint64_t)display_width * height > (uint64_t)display_height * width)
		fit.width = (uint32_t)(((uint64_t)display_height * width + height / 2) / height);
	else
		fit.height = (uint32_t)(((uint64_t)display_width * height + width / 2) / width);
	fit.width += fit.width == 0;
	fit.height += fit.height == 0;
	fit.x = (display_width - fit.width) / 2;
	fit.y = (display_height - fit.height) / 2;
	return fit;
}

#endif
