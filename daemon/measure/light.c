/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/measure/light.h"

#include <math.h>

static double to_light(double code, double gamma)
{
	if (gamma > 0.0)
		return pow(code, gamma);
	return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
}

static double from_light(double light, double gamma)
{
	if (gamma > 0.0)
		return pow(light, 1.0 / gamma);
	return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055;
}

void light_transfer_init(struct light_transfer *transfer, double gamma)
{
	for (uint32_t code = 0; code < 256; code++)
		transfer->light[code] = (float)to_light(code / 255.0, gamma);
	for (uint32_t step = 0; step < LIGHT_STEPS; step++)
		transfer->code[step] = (uint8_t)lrint(255.0 * from_light(step / (LIGHT_STEPS - 1.0), gamma));
}

void light_from_picture(const struct light_transfer *transfer, const struct picture *picture, light_pixel *light)
{
	for (uint32_t y = 0; y < picture->height; y++) {
		const uint8_t *row = picture->data + y * picture->stride;
		for (uint32_t x = 0; x < picture->width; x++, row += 4)
			*light++ = (light_pixel){transfer->light[row[0]], transfer->light[row[1]], transfer->light[row[2]], 0.0f};
	}
}

void light_to_codes(const struct light_transfer *transfer, const light_pixel *light, size_t pixels, uint8_t *bgra)
{
	const float most = (float)(LIGHT_STEPS - 1);
	for (size_t i = 0; i < pixels; i++, bgra += 4) {
		for (int channel = 0; channel < 3; channel++) {
			const float value = light[i][channel];
			const float bound = !(value > 0.0f) ? 0.0f : value > 1.0f ? 1.0f : value;
			bgra[channel] = transfer->code[(uint32_t)(bound * most + 0.5f)];
		}
		bgra[3] = 255;
	}
}

double light_mean_luminance(const light_pixel *light, size_t pixels)
{
	double blue = 0.0, green = 0.0, red = 0.0;
	for (size_t i = 0; i < pixels; i++) {
		blue += (double)light[i][0];
		green += (double)light[i][1];
		red += (double)light[i][2];
	}
	return pixels ? (0.0722 * blue + 0.7152 * green + 0.2126 * red) / (double)pixels : 0.0;
}

double light_ripple(const double *luminances, uint32_t count)
{
	if (count == 0)
		return 0.0;
	double least = luminances[0], greatest = luminances[0];
	for (uint32_t i = 1; i < count; i++) {
		least = fmin(least, luminances[i]);
		greatest = fmax(greatest, luminances[i]);
	}
	return greatest > 0.0 ? (greatest - least) / (greatest + least) : 0.0;
}
