/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/bounds.h"

#include <stddef.h>
#include <string.h>

void bounds_widen(struct bounds *bounds, const uint8_t *pixels, uint32_t width, uint32_t y)
{
	static const uint8_t nothing[4];
	uint32_t left = 0, right = width;
	while (left < right && memcmp(pixels + 4 * (size_t)left, nothing, 4) == 0)
		left++;
	if (left == right)
		return;
	while (memcmp(pixels + 4 * (size_t)(right - 1), nothing, 4) == 0)
		right--;
	bool first = bounds_empty(bounds);
	bounds->left = first || left < bounds->left ? left : bounds->left;
	bounds->right = first || right > bounds->right ? right : bounds->right;
	bounds->top = first ? y : bounds->top;
	bounds->bottom = y + 1;
}
