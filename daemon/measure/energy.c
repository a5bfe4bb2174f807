/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/measure/energy.h"

#include <math.h>
#include <stdlib.h>

struct frame_energy {
	const light_pixel *original;
	const struct energy_picture *pictures;
	uint32_t count, width, height;
};

static bool is_seen(const struct energy_picture *picture, size_t pixel)
{
	return !picture->hidden || !(picture->hidden[pixel] & picture->hidden_bits);
}

/* Mean light of all pictures minus the original at one pixel; false if one of them does not show it. */
static bool pixel_error(const struct frame_energy *frame, uint32_t i, uint32_t j, light_pixel *error)
{
	const size_t pixel = (size_t)j * frame->width + i;
	light_pixel sum = {0};
	for (uint32_t k = 0; k < frame->count; k++) {
		const struct energy_picture *picture = &frame->pictures[k];
		if (!is_seen(picture, pixel))
			return false;
		float x = (float)i + 0.5f, y = (float)j + 0.5f;
		if (picture->motion) {
			x += picture->motion[2 * pixel];
			y += picture->motion[2 * pixel + 1];
		}
		sum += light_sample(picture->light, frame->width, frame->height, x, y);
	}
	*error = sum / (float)frame->count - frame->original[pixel];
	return true;
}

static void add_block(struct energy_error *error, const struct frame_energy *frame, uint32_t left, uint32_t top)
{
	light_pixel sum = {0}, light = {0}, one;
	for (uint32_t j = top; j < top + ENERGY_BLOCK; j++) {
		for (uint32_t i = left; i < left + ENERGY_BLOCK; i++) {
			if (!pixel_error(frame, i, j, &one))
				return;
			sum += one;
			light += frame->original[(size_t)j * frame->width + i];
		}
	}
	for (int channel = 0; channel < 3; channel++) {
		const double mean = (double)sum[channel] / (ENERGY_BLOCK * ENERGY_BLOCK);
		error->squares += mean * mean;
		error->signed_sum += mean;
		error->light += (double)light[channel] / (ENERGY_BLOCK * ENERGY_BLOCK);
	}
	error->count += 3;
}

void energy_error_add(struct energy_error *error, const light_pixel *original, const struct energy_picture *pictures,
					  uint32_t count, uint32_t width, uint32_t height)
{
	const struct frame_energy frame = {original, pictures, count, width, height};
	for (uint32_t top = 0; top + ENERGY_BLOCK <= height; top += ENERGY_BLOCK)
		for (uint32_t left = 0; left + ENERGY_BLOCK <= width; left += ENERGY_BLOCK)
			add_block(error, &frame, left, top);
}

double energy_error_root(const struct energy_error *error)
{
	const double count = (double)error->count;
	return error->light > 0.0 ? sqrt(error->squares / count) / (error->light / count) : (double)NAN;
}

double energy_error_bias(const struct energy_error *error)
{
	return error->light > 0.0 ? error->signed_sum / error->light : (double)NAN;
}
