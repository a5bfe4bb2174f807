/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "client/gl_rows.h"

#include <string.h>

#define SIGN16_OF_Y 0x80000000u
#define SIGN32_OF_Y UINT64_C(0x8000000000000000)

uint16_t shim_half(float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof(bits));
	uint32_t sign = bits >> 16 & 0x8000u, magnitude = bits & 0x7fffffffu;

	if (magnitude >= 0x7f800000u) {
		return (uint16_t)(sign | 0x7c00u | (magnitude > 0x7f800000u ? 0x200u : 0));
	}
	if (magnitude >= 0x477ff000u) { /* 65520: halfway beyond the largest half */
		return (uint16_t)(sign | 0x7c00u);
	}
	if (magnitude < 0x38800000u) { /* a denormal half, or 0 */
		uint32_t shift = 126 - (magnitude >> 23);
		if (shift > 24) {
			return (uint16_t)sign;
		}
		uint32_t mantissa = (magnitude & 0x7fffffu) | 0x800000u;
		uint32_t kept = mantissa >> shift, rest = mantissa & ((1u << shift) - 1), middle = 1u << (shift - 1);
		return (uint16_t)(sign | (kept + (rest > middle || (rest == middle && (kept & 1)))));
	}
	uint32_t rounded = magnitude - 0x38000000u + 0xfffu + (magnitude >> 13 & 1);
	return (uint16_t)(sign | rounded >> 13);
}

static float float_at(const uint8_t *from, uint32_t index)
{
	float value;
	memcpy(&value, from + (size_t)index * sizeof(value), sizeof(value));
	return value;
}

static uint32_t uint_at(const uint8_t *from, uint32_t index)
{
	uint32_t value;
	memcpy(&value, from + (size_t)index * sizeof(value), sizeof(value));
	return value;
}

/* Not true for NaN, so NaN becomes 0. */
static double clamp_unit(float value)
{
	return value > 0.0f ? value < 1.0f ? (double)value : 1.0 : 0.0;
}

void shim_row_copy(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	memcpy(to, from, (size_t)width * options->pixel_bytes);
}

void shim_row_swap(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	for (uint32_t x = 0; x < width; x++) {
		uint32_t pixel = uint_at(from, x);
		pixel = (pixel & 0xff00ff00u) | (pixel & 0xffu) << 16 | (pixel >> 16 & 0xffu);
		memcpy(to + (size_t)x * 4, &pixel, 4);
	}
}

void shim_row_color_half(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	for (uint32_t i = 0; i < width * 4; i++) {
		uint16_t half = shim_half(float_at(from, i));
		memcpy(to + (size_t)i * 2, &half, 2);
	}
}

void shim_row_depth_float(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	for (uint32_t x = 0; x < width; x++) {
		memcpy(to + (size_t)x * 4, from + (size_t)x * options->channels * 4, 4);
	}
}

void shim_row_depth16(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	for (uint32_t x = 0; x < width; x++) {
		uint16_t depth = (uint16_t)(clamp_unit(float_at(from, x * options->channels)) * 65535.0 + 0.5);
		memcpy(to + (size_t)x * 2, &depth, 2);
	}
}

void shim_row_depth24(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	for (uint32_t x = 0; x < width; x++) {
		uint32_t depth = (uint32_t)(clamp_unit(float_at(from, x * options->channels)) * 16777215.0 + 0.5);
		memcpy(to + (size_t)x * 4, &depth, 4);
	}
}

void shim_row_motion_half(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	uint32_t turn = options->negate_y ? SIGN16_OF_Y : 0;

	for (uint32_t x = 0; x < width; x++) {
		uint32_t pixel = uint_at(from, x) ^ turn;
		memcpy(to + (size_t)x * 4, &pixel, 4);
	}
}

void shim_row_motion_float(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	uint64_t turn = options->negate_y ? SIGN32_OF_Y : 0;

	for (uint32_t x = 0; x < width; x++) {
		uint64_t pixel;
		memcpy(&pixel, from + (size_t)x * options->channels * 4, 8);
		pixel ^= turn;
		memcpy(to + (size_t)x * 8, &pixel, 8);
	}
}

void shim_row_motion_to_half(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	for (uint32_t x = 0; x < width; x++) {
		uint32_t i = x * options->channels;
		uint32_t pixel = shim_half(float_at(from, i)) | (uint32_t)shim_half(float_at(from, i + 1)) << 16;
		pixel ^= options->negate_y ? SIGN16_OF_Y : 0;
		memcpy(to + (size_t)x * 4, &pixel, 4);
	}
}

void shim_row_id8(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	for (uint32_t x = 0; x < width; x++) {
		uint32_t id = uint_at(from, x * options->channels);
		to[x] = (uint8_t)(id < 0xff ? id : 0xff);
	}
}

void shim_row_id16(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	for (uint32_t x = 0; x < width; x++) {
		uint32_t id = uint_at(from, x * options->channels);
		uint16_t small = (uint16_t)(id < 0xffff ? id : 0xffff);
		memcpy(to + (size_t)x * 2, &small, 2);
	}
}

void shim_row_id32(uint8_t *to, const uint8_t *from, uint32_t width, const struct shim_row_options *options)
{
	for (uint32_t x = 0; x < width; x++) {
		memcpy(to + (size_t)x * 4, from + (size_t)x * options->channels * 4, 4);
	}
}
