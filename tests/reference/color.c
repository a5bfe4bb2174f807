/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Colour: transfers, formats, conversion to code values of the display (docs/method.md, 0). */
#include "reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void *reference_alloc(size_t count, size_t size)
{
	void *memory = calloc(count ? count : 1, size);
	if (!memory)
		abort();
	return memory;
}

double reference_to_light(const struct reference_transfer *transfer, double code)
{
	switch (transfer->curve) {
	case PURSUIT_CURVE_SRGB:
		return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
	case PURSUIT_CURVE_GAMMA:
		/* A power of a negative code has no meaning: no light. */
		return code <= 0.0 ? 0.0 : pow(code, transfer->gamma);
	default:
		return code;
	}
}

double reference_half_step(const struct reference_transfer *transfer, double code)
{
	const double low = fmax(code - 0.5 / 255.0, 0.0), high = fmin(code + 0.5 / 255.0, 1.0);
	const double light = reference_to_light(transfer, code);
	return fmax(reference_to_light(transfer, high) - light, light - reference_to_light(transfer, low));
}

double reference_from_light(const struct reference_transfer *transfer, double light)
{
	switch (transfer->curve) {
	case PURSUIT_CURVE_SRGB:
		return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055;
	case PURSUIT_CURVE_GAMMA:
		return light <= 0.0 ? 0.0 : pow(light, 1.0 / transfer->gamma);
	default:
		return light;
	}
}

static double clamp01(double x)
{
	if (!(x > 0.0))
		return 0.0;
	return x < 1.0 ? x : 1.0;
}

double reference_smoothstep(double a, double b, double x)
{
	const double t = clamp01((x - a) / (b - a));
	return t * t * (3.0 - 2.0 * t);
}

uint8_t reference_code8(double x, double bias)
{
	const double code = floor(255.0 * clamp01(x) + 0.5 + bias);
	return (uint8_t)(code < 0.0 ? 0.0 : code > 255.0 ? 255.0 : code);
}

double reference_half(uint16_t half)
{
	const int exponent = (half >> 10) & 31;
	const int mantissa = half & 1023;
	const double sign = half & 0x8000 ? -1.0 : 1.0;
	if (exponent == 31)
		return mantissa ? (double)NAN : sign * (double)INFINITY;
	if (exponent == 0)
		return sign * ldexp(mantissa, -24);
	return sign * ldexp(1024 + mantissa, exponent - 25);
}

void reference_picture_init(struct reference_picture *picture, uint32_t width, uint32_t height)
{
	reference_picture_finish(picture);
	picture->width = width;
	picture->height = height;
	picture->data = reference_alloc((size_t)width * height, 4);
}

void reference_picture_finish(struct reference_picture *picture)
{
	free(picture->data);
	*picture = (struct reference_picture){0};
}

static long clamp_index(double index, uint32_t count)
{
	if (index < 0.0)
		return 0;
	return index > (double)count - 1.0 ? (long)count - 1 : (long)index;
}

void reference_sample(const struct reference_picture *picture, double x, double y, double out[3])
{
	const double i = floor(x - 0.5), j = floor(y - 0.5);
	const double fx = x - 0.5 - i, fy = y - 0.5 - j;
	const long i0 = clamp_index(i, picture->width), i1 = clamp_index(i + 1.0, picture->width);
	const long j0 = clamp_index(j, picture->height), j1 = clamp_index(j + 1.0, picture->height);
	const long width = (long)picture->width;
	for (int c = 0; c < 3; c++) {
		const double v00 = picture->data[(j0 * width + i0) * 4 + c], v10 = picture->data[(j0 * width + i1) * 4 + c];
		const double v01 = picture->data[(j1 * width + i0) * 4 + c], v11 = picture->data[(j1 * width + i1) * 4 + c];
		out[c] = (1.0 - fy) * ((1.0 - fx) * v00 + fx * v10) + fy * ((1.0 - fx) * v01 + fx * v11);
	}
}

/* Components as the format stores them, R G B A, 0 to 1 or whatever a half holds. */
static void decode_color(uint32_t format, const uint8_t *pixel, double rgba[4])
{
	uint32_t word;
	uint16_t halves[4];
	switch (format) {
	case PURSUIT_FORMAT_BGRA8:
		rgba[0] = pixel[2] / 255.0;
		rgba[1] = pixel[1] / 255.0;
		rgba[2] = pixel[0] / 255.0;
		rgba[3] = pixel[3] / 255.0;
		break;
	case PURSUIT_FORMAT_RGBA8:
		for (int c = 0; c < 4; c++)
			rgba[c] = pixel[c] / 255.0;
		break;
	case PURSUIT_FORMAT_RGB10A2:
		memcpy(&word, pixel, sizeof(word));
		for (int c = 0; c < 3; c++)
			rgba[c] = (word >> (10 * c) & 1023) / 1023.0;
		rgba[3] = (word >> 30) / 3.0;
		break;
	case PURSUIT_FORMAT_RGBA16F:
		memcpy(halves, pixel, sizeof(halves));
		for (int c = 0; c < 4; c++)
			rgba[c] = reference_half(halves[c]);
		break;
	default:
		abort();
	}
}

static double convert_channel(double code, const struct pursuit_transfer *from,
							  const struct reference_transfer *display)
{
	const struct reference_transfer source = {from->curve, (double)from->gamma};
	const bool plain_range = from->black == 0.0f && from->peak == 0.0f;
	const double black = plain_range ? 0.0 : (double)from->black, peak = plain_range ? 1.0 : (double)from->peak;
	const double light = clamp01((reference_to_light(&source, code) - black) / (peak - black)); /* NaN gives 0 */
	return reference_from_light(display, light);
}

void reference_convert_color(struct reference_picture *out, const struct pursuit_plane *plane, const uint8_t *data,
							 const struct reference_transfer *display)
{
	const uint32_t bytes = pursuit_format_bytes(plane->format);
	reference_picture_init(out, plane->width, plane->height);
	for (uint32_t j = 0; j < plane->height; j++)
		for (uint32_t i = 0; i < plane->width; i++) {
			uint8_t *to = &out->data[((size_t)j * plane->width + i) * 4];
			double rgba[4];
			decode_color(plane->format, data + j * plane->stride + (size_t)i * bytes, rgba);
			for (int c = 0; c < 3; c++)
				to[c] = reference_code8(convert_channel(rgba[2 - c], &plane->transfer, display), 0.0);
			to[3] = 255;
		}
}

void reference_convert_ui(struct reference_picture *out, const struct pursuit_plane *plane, const uint8_t *data)
{
	reference_picture_init(out, plane->width, plane->height);
	for (uint32_t j = 0; j < plane->height; j++)
		for (uint32_t i = 0; i < plane->width; i++) {
			const uint8_t *from = data + j * plane->stride + (size_t)i * 4;
			uint8_t *to = &out->data[((size_t)j * plane->width + i) * 4];
			const bool rgba = plane->format == PURSUIT_FORMAT_RGBA8;
			to[0] = from[rgba ? 2 : 0];
			to[1] = from[1];
			to[2] = from[rgba ? 0 : 2];
			to[3] = from[3];
		}
}

double reference_over(double ui, double ui_alpha, double under)
{
	return clamp01(ui + (1.0 - ui_alpha) * under);
}
