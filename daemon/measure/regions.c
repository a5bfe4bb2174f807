/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/measure/regions.h"

#include <math.h>
#include <string.h>

#define LEAST_MOTION 0.25f
#define WAY_BACK 1.0f
#define NEARER 1.1f

/* Where a pixel lies at the other moment. */
struct place {
	float x, y;
	bool inside;
};

static struct place lead(const struct region_view *view, uint32_t width, uint32_t height, uint32_t i, uint32_t j)
{
	const float *motion = view->motion + 2 * ((size_t)j * width + i);
	const float x = (float)i + 0.5f + motion[0], y = (float)j + 0.5f + motion[1];
	return (struct place){x, y, x >= 0.0f && y >= 0.0f && x < (float)width && y < (float)height};
}

static bool leads_back(const struct region_view *here, const struct region_view *there, uint32_t width, size_t pixel,
					   int i, int j)
{
	const size_t other = (size_t)j * width + (size_t)i;
	if (here->object_id && there->object_id && here->object_id[pixel] != there->object_id[other])
		return false;
	const float *motion = there->motion + 2 * other;
	const float x = (float)i + 0.5f + motion[0] - ((float)(pixel % width) + 0.5f);
	const float y = (float)j + 0.5f + motion[1] - ((float)(pixel / width) + 0.5f);
	return x * x + y * y <= WAY_BACK * WAY_BACK;
}

static bool is_seen(const struct region_view *here, const struct region_view *there, uint32_t width, uint32_t height,
					size_t pixel, const struct place *place)
{
	const int left = (int)floorf(place->x - 0.5f), top = (int)floorf(place->y - 0.5f);
	for (int j = top; j <= top + 1; j++) {
		for (int i = left; i <= left + 1; i++) {
			const bool inside = i >= 0 && j >= 0 && i < (int)width && j < (int)height;
			if (inside && leads_back(here, there, width, pixel, i, j))
				return true;
		}
	}
	return false;
}

static uint8_t moving(const float *motion)
{
	return motion[0] * motion[0] + motion[1] * motion[1] >= LEAST_MOTION * LEAST_MOTION ? REGION_MOVING : 0;
}

void regions_find(const struct region_view *here, const struct region_view *there, uint32_t width, uint32_t height,
				  uint8_t *mask)
{
	for (uint32_t j = 0; j < height; j++) {
		for (uint32_t i = 0; i < width; i++) {
			const size_t pixel = (size_t)j * width + i;
			const struct place place = lead(here, width, height, i, j);
			const bool seen = place.inside && is_seen(here, there, width, height, pixel, &place);
			mask[pixel] = (uint8_t)(moving(here->motion + 2 * pixel) | (seen ? 0u : REGION_HIDDEN));
		}
	}
}

void regions_guess(const struct region_view *here, const struct region_view *there, uint32_t width, uint32_t height,
				   uint8_t *mask)
{
	for (uint32_t j = 0; j < height; j++) {
		for (uint32_t i = 0; i < width; i++) {
			const size_t pixel = (size_t)j * width + i;
			const struct place place = lead(here, width, height, i, j);
			bool hidden = !place.inside;
			if (place.inside && here->distance && there->distance) {
				const size_t other = (size_t)place.y * width + (size_t)place.x;
				hidden = there->distance[other] * NEARER < here->distance[pixel];
			}
			mask[pixel] = (uint8_t)(moving(here->motion + 2 * pixel) | (hidden ? REGION_HIDDEN : 0u));
		}
	}
}

void squared_error_add(struct squared_error *error, const struct picture *a, const struct picture *b,
					   const uint8_t *mask, uint8_t bits)
{
	uint64_t sum = 0, count = 0;
	for (uint32_t y = 0; y < a->height; y++) {
		const uint8_t *p = a->data + y * a->stride, *q = b->data + y * b->stride;
		const uint8_t *chosen = mask ? mask + (size_t)y * a->width : NULL;
		for (uint32_t x = 0; x < a->width; x++, p += 4, q += 4) {
			if (chosen && (chosen[x] & bits) != bits)
				continue;
			const int blue = p[0] - q[0], green = p[1] - q[1], red = p[2] - q[2];
			sum += (uint64_t)(blue * blue + green * green + red * red);
			count++;
		}
	}
	error->sum += (double)sum;
	error->count += count;
}

double squared_error_root(const struct squared_error *error)
{
	return error->count ? sqrt(error->sum / (3.0 * (double)error->count)) : (double)NAN;
}

double squared_error_psnr(const struct squared_error *error)
{
	const double root = squared_error_root(error);
	return root > 0.0 ? fmin(100.0, 20.0 * log10(255.0 / root)) : root == 0.0 ? 100.0 : (double)NAN;
}
