/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/cpu/light.h"

#include <math.h>
#include <string.h>

#include "daemon/engine/convert.h"

static uint32_t bits_of(float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof(bits));
	return bits;
}

static float float_of(uint32_t bits)
{
	float value;
	memcpy(&value, &bits, sizeof(value));
	return value;
}

/* The power of two below which everything rounds to code value 0. */
static float find_least(enum engine_curve curve, double gamma)
{
	double least = 0.5;
	uint32_t octaves = 1;
	while (octaves < LIGHT_MOST_OCTAVES && 255.0 * convert_from_light(least, curve, gamma) > 0.25) {
		least *= 0.5;
		octaves++;
	}
	return (float)least;
}

void light_prepare(struct light *light, enum engine_curve curve, float gamma)
{
	if (light->made && light->curve == curve && light->gamma == gamma)
		return;
	light->made = true;
	light->curve = curve;
	light->gamma = gamma;
	for (uint32_t i = 0; i <= 255 * LIGHT_FINE + 1; i++) {
		double code = fmin(i / (255.0 * LIGHT_FINE), 1.0);
		light->fine[i] = (float)convert_to_light(code, curve, (double)gamma);
	}
	float least = find_least(curve, (double)gamma);
	light->least_bits = bits_of(least);
	uint32_t last = (bits_of(1.0f) - light->least_bits) >> (23u - LIGHT_MANTISSA_BITS);
	for (uint32_t i = 0; i <= last + 1; i++) {
		float at = float_of(light->least_bits + (i << (23u - LIGHT_MANTISSA_BITS)));
		light->codes[i] = (float)(255.0 * convert_from_light(fmin((double)at, 1.0), curve, (double)gamma));
	}
	light->below = light->codes[0] / least;
}
