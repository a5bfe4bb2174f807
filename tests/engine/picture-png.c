/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <png.h>

#include "tests/engine/picture.h"

bool picture_write_png(const char *path, const uint8_t *bgra, uint32_t width, uint32_t height)
{
	png_image image = {.version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = PNG_FORMAT_BGRA};
	return png_image_write_to_file(&image, path, 0, bgra, 0, NULL);
}
