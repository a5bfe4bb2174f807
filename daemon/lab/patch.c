/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/patch.h"

void patch_draw(const struct presenter_image *image, uint32_t corner, uint32_t size, bool white)
{
	const uint32_t width = size < image->width ? size : image->width;
	const uint32_t height = size < image->height ? size : image->height;
	const uint32_t left = corner & 1 ? image->width - width : 0;
	const uint32_t top = corner & 2 ? image->height - height : 0;
	for (uint32_t y = top; y < top + height; y++) {
		uint8_t *pixel = image->data + y * image->stride + (size_t)left * 4;
		for (uint32_t x = 0; x < width; x++, pixel += 4) {
			pixel[0] = pixel[1] = pixel[2] = white ? 255 : 0;
			pixel[3] = 255;
		}
	}
}
