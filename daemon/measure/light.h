/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The light that a display emits, for measures that add light up: code values
 * to linear light (1: the brightest) and back. Pure arithmetic, any thread.
 */
#ifndef PURSUIT_MEASURE_LIGHT_H
#define PURSUIT_MEASURE_LIGHT_H

#include "measure.h"

/* Blue, green, red, 0; so that four are added at once. */
typedef float light_pixel __attribute__((vector_size(16)));

#define LIGHT_STEPS 65536u

struct light_transfer {
	float light[256];          /* of a code value */
	uint8_t code[LIGHT_STEPS]; /* nearest code value of light i / (LIGHT_STEPS - 1) */
};

/* Fills the tables: gamma 0 is sRGB (IEC 61966-2-1, piecewise), else light = code^gamma, gamma 1 to 5. */
void light_transfer_init(struct light_transfer *transfer, double gamma);

/* A picture in light, packed rows: width x height pixels, the caller's. */
void light_from_picture(const struct light_transfer *transfer, const struct picture *picture, light_pixel *light);

/* Packed BGRA8, alpha 255; light is clamped to 0..1, NaN gives 0. */
void light_to_codes(const struct light_transfer *transfer, const light_pixel *light, size_t pixels, uint8_t *bgra);

/* Light between pixels: bilinear, (x, y) in pixels, pixel centres at .5, clamped at the edge. x, y finite. */
static inline light_pixel light_sample(const light_pixel *light, uint32_t width, uint32_t height, float x, float y)
{
	const float right = (float)(width - 1), bottom = (float)(height - 1);
	x -= 0.5f;
	y -= 0.5f;
	x = x < 0.0f ? 0.0f : x > right ? right : x;
	y = y < 0.0f ? 0.0f : y > bottom ? bottom : y;
	const uint32_t i = (uint32_t)x, j = (uint32_t)y;
	const uint32_t next_i = i + 1 < width ? i + 1 : i, next_j = j + 1 < height ? j + 1 : j;
	const float u = x - (float)i, v = y - (float)j;
	const light_pixel *top = light + (size_t)j * width, *low = light + (size_t)next_j * width;
	const light_pixel above = top[i] + u * (top[next_i] - top[i]), below = low[i] + u * (low[next_i] - low[i]);
	return above + v * (below - above);
}

/* Mean luminance of a picture's light, 0 to 1: Rec. 709 weights, which sRGB shares. */
double light_mean_luminance(const light_pixel *light, size_t pixels);

/*
 * Ripple of some mean luminances, those of the pictures shown for one real
 * frame: Michelson contrast (greatest - least) / (greatest + least); 0 where
 * all are dark. 1: dark frames between bright ones.
 */
double light_ripple(const double *luminances, uint32_t count);

#endif
