/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/convert.h"

#include <math.h>
#include <string.h>

double convert_to_light(double code, enum engine_curve curve, double gamma)
{
	/* A power of something negative has no meaning: no light. */
	if (curve == ENGINE_CURVE_GAMMA)
		return code <= 0.0 ? 0.0 : pow(code, gamma);
	return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
}

double convert_from_light(double light, enum engine_curve curve, double gamma)
{
	if (curve == ENGINE_CURVE_GAMMA)
		return pow(light, 1.0 / gamma);
	return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1.0 / 2.4) - 0.055;
}

static double half_to_double(uint32_t half)
{
	int exponent = (int)(half >> 10) & 31;
	double fraction = (double)(half & 1023u) / 1024.0;
	double value = ldexp(1.0 + fraction, exponent - 15);
	if (exponent == 0)
		value = ldexp(fraction, -14);
	else if (exponent == 31)
		value = fraction > 0.0 ? (double)NAN : (double)INFINITY;
	return half & 0x8000u ? -value : value;
}

/* The number that a component of the plane stands for. */
static double decode_component(uint32_t format, uint32_t bits)
{
	if (format == PURSUIT_FORMAT_RGBA16F)
		return half_to_double(bits);
	return format == PURSUIT_FORMAT_RGB10A2 ? bits / 1023.0 : bits / 255.0;
}

/* To [0, 1], NaN to 0. */
static double saturate(double value)
{
	if (!(value > 0.0))
		return 0.0;
	return value < 1.0 ? value : 1.0;
}

static double decode_light(const struct pursuit_transfer *transfer, double code)
{
	switch (transfer->curve) {
	case PURSUIT_CURVE_LINEAR:
		return code;
	case PURSUIT_CURVE_GAMMA:
		return convert_to_light(code, ENGINE_CURVE_GAMMA, (double)transfer->gamma);
	default:
		return convert_to_light(code, ENGINE_CURVE_SRGB, 0.0);
	}
}

static uint8_t code8(double value)
{
	return (uint8_t)floor(255.0 * saturate(value) + 0.5);
}

static uint8_t convert_component(const struct convert *convert, uint32_t bits)
{
	double code = decode_component(convert->format, bits);
	if (convert->identity)
		return code8(code);
	double black = (double)convert->transfer.black, peak = (double)convert->transfer.peak;
	if (!(peak > black)) {
		black = 0.0;
		peak = 1.0;
	}
	double light = (decode_light(&convert->transfer, code) - black) / (peak - black);
	return code8(convert_from_light(saturate(light), convert->curve, (double)convert->gamma));
}

/* Whether the plane's transfer is the display's own. */
static bool is_identity(const struct pursuit_transfer *transfer, enum engine_curve curve, float gamma)
{
	bool full = (transfer->black == 0.0f && (transfer->peak == 1.0f || transfer->peak == 0.0f));
	if (!full)
		return false;
	if (curve == ENGINE_CURVE_GAMMA)
		return (transfer->curve == PURSUIT_CURVE_GAMMA && transfer->gamma == gamma) ||
			   (transfer->curve == PURSUIT_CURVE_LINEAR && gamma == 1.0f);
	return transfer->curve == PURSUIT_CURVE_SRGB;
}

static uint32_t component_values(uint32_t format)
{
	return format == PURSUIT_FORMAT_RGBA16F ? 65536u : format == PURSUIT_FORMAT_RGB10A2 ? 1024u : 256u;
}

void convert_prepare(struct convert *convert, uint32_t format, const struct pursuit_transfer *transfer,
					 enum engine_curve curve, float gamma)
{
	struct pursuit_transfer wanted = {0};
	if (transfer)
		wanted = *transfer;
	bool same = convert->made && convert->format == format && convert->curve == curve && convert->gamma == gamma &&
				memcmp(&convert->transfer, &wanted, sizeof(wanted)) == 0;
	if (same)
		return;
	convert->format = format;
	convert->transfer = wanted;
	convert->curve = curve;
	convert->gamma = gamma;
	convert->identity = !transfer || is_identity(transfer, curve, gamma);
	for (uint32_t i = 0; i < component_values(format); i++)
		convert->table[i] = convert_component(convert, i);
	convert->made = true;
}

static void copy_bgra(uint8_t *to, const uint8_t *from, uint32_t width, uint32_t alpha)
{
	for (uint32_t i = 0; i < width; i++) {
		uint32_t pixel;
		memcpy(&pixel, from + 4 * (size_t)i, 4);
		pixel |= alpha;
		memcpy(to + 4 * (size_t)i, &pixel, 4);
	}
}

static void copy_rgba(uint8_t *to, const uint8_t *from, uint32_t width, uint32_t alpha)
{
	for (uint32_t i = 0; i < width; i++) {
		uint32_t pixel;
		memcpy(&pixel, from + 4 * (size_t)i, 4);
		pixel = (pixel & 0xff00ff00u) | ((pixel >> 16) & 0xffu) | ((pixel & 0xffu) << 16) | alpha;
		memcpy(to + 4 * (size_t)i, &pixel, 4);
	}
}

static void convert_8(const struct convert *convert, uint8_t *to, const uint8_t *from, uint32_t width, uint8_t alpha)
{
	unsigned red = convert->format == PURSUIT_FORMAT_RGBA8 ? 0 : 2;
	for (uint32_t i = 0; i < width; i++, from += 4, to += 4) {
		to[0] = convert->table[from[2 - red]];
		to[1] = convert->table[from[1]];
		to[2] = convert->table[from[red]];
		to[3] = (uint8_t)(from[3] | alpha);
	}
}

static void convert_10(const struct convert *convert, uint8_t *to, const uint8_t *from, uint32_t width, uint8_t alpha)
{
	for (uint32_t i = 0; i < width; i++, from += 4, to += 4) {
		uint32_t pixel;
		memcpy(&pixel, from, 4);
		to[0] = convert->table[(pixel >> 20) & 1023u];
		to[1] = convert->table[(pixel >> 10) & 1023u];
		to[2] = convert->table[pixel & 1023u];
		to[3] = (uint8_t)((pixel >> 30) * 85u | alpha);
	}
}

static void convert_16f(const struct convert *convert, uint8_t *to, const uint8_t *from, uint32_t width, bool opaque)
{
	for (uint32_t i = 0; i < width; i++, from += 8, to += 4) {
		uint16_t pixel[4];
		memcpy(pixel, from, 8);
		to[0] = convert->table[pixel[2]];
		to[1] = convert->table[pixel[1]];
		to[2] = convert->table[pixel[0]];
		to[3] = opaque ? 255 : code8(decode_component(PURSUIT_FORMAT_RGBA16F, pixel[3]));
	}
}

void convert_row(const struct convert *convert, uint8_t *to, const uint8_t *from, uint32_t width, bool opaque)
{
	uint8_t alpha = opaque ? 255 : 0;
	switch (convert->format) {
	case PURSUIT_FORMAT_RGBA16F:
		convert_16f(convert, to, from, width, opaque);
		break;
	case PURSUIT_FORMAT_RGB10A2:
		convert_10(convert, to, from, width, alpha);
		break;
	case PURSUIT_FORMAT_RGBA8:
		if (convert->identity)
			copy_rgba(to, from, width, (uint32_t)alpha << 24);
		else
			convert_8(convert, to, from, width, alpha);
		break;
	default:
		if (convert->identity)
			copy_bgra(to, from, width, (uint32_t)alpha << 24);
		else
			convert_8(convert, to, from, width, alpha);
	}
}
