/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "pixel.h"

#include <math.h>
#include <string.h>

#include "daemon/record/half.h"
#include "proto/frame.h"

static float light_from_code(uint8_t code)
{
	float c = (float)code / 255.0f;
	return c <= 0.04045f ? c / 12.92f : powf((c + 0.055f) / 1.055f, 2.4f);
}

static void write_half_color(const uint8_t *bgra, uint32_t width, uint8_t *row)
{
	uint16_t half[256];
	for (uint32_t code = 0; code < 256; code++)
		half[code] = half_from_float(light_from_code((uint8_t)code));
	for (uint32_t x = 0; x < width; x++) {
		const uint16_t pixel[4] = {half[bgra[4 * x + 2]], half[bgra[4 * x + 1]], half[bgra[4 * x]], 0x3c00u};
		memcpy(row + 8 * (size_t)x, pixel, sizeof(pixel));
	}
}

static void write_deep_color(const uint8_t *bgra, uint32_t width, uint8_t *row)
{
	for (uint32_t x = 0; x < width; x++) {
		uint32_t pixel = 3u << 30;
		for (uint32_t channel = 0; channel < 3; channel++) {
			uint32_t code = bgra[4 * x + 2 - channel];
			pixel |= (code * 1023u + 127u) / 255u << 10 * channel;
		}
		memcpy(row + 4 * (size_t)x, &pixel, sizeof(pixel));
	}
}

void pixel_write_color(uint32_t format, const uint8_t *bgra, uint32_t width, uint8_t *row)
{
	switch (format) {
	case PURSUIT_FORMAT_RGBA16F:
		write_half_color(bgra, width, row);
		break;
	case PURSUIT_FORMAT_RGB10A2:
		write_deep_color(bgra, width, row);
		break;
	case PURSUIT_FORMAT_RGBA8:
		for (uint32_t x = 0; x < width; x++) {
			const uint8_t pixel[4] = {bgra[4 * x + 2], bgra[4 * x + 1], bgra[4 * x], bgra[4 * x + 3]};
			memcpy(row + 4 * (size_t)x, pixel, sizeof(pixel));
		}
		break;
	default:
		memcpy(row, bgra, 4 * (size_t)width);
	}
}

void pixel_write_depth(uint32_t format, const float *depth, uint32_t width, uint8_t *row)
{
	if (format == PURSUIT_FORMAT_DEPTH32F) {
		memcpy(row, depth, 4 * (size_t)width);
		return;
	}
	for (uint32_t x = 0; x < width; x++) {
		double value = fmin(fmax((double)depth[x], 0.0), 1.0);
		if (format == PURSUIT_FORMAT_DEPTH16) {
			uint16_t pixel = (uint16_t)lrint(value * 65535.0);
			memcpy(row + 2 * (size_t)x, &pixel, sizeof(pixel));
		} else {
			uint32_t pixel = (uint32_t)lrint(value * 16777215.0);
			memcpy(row + 4 * (size_t)x, &pixel, sizeof(pixel));
		}
	}
}

void pixel_read_depth(uint32_t format, const uint8_t *row, uint32_t width, float *depth)
{
	for (uint32_t x = 0; x < width; x++) {
		uint16_t half;
		uint32_t word;
		switch (format) {
		case PURSUIT_FORMAT_DEPTH16:
			memcpy(&half, row + 2 * (size_t)x, sizeof(half));
			depth[x] = (float)half / 65535.0f;
			break;
		case PURSUIT_FORMAT_DEPTH24:
			memcpy(&word, row + 4 * (size_t)x, sizeof(word));
			depth[x] = (float)(word & 0xffffffu) / 16777215.0f;
			break;
		default:
			memcpy(depth + x, row + 4 * (size_t)x, sizeof(*depth));
		}
	}
}

void pixel_write_motion(uint32_t format, const float *motion, uint32_t width, uint8_t *row)
{
	if (format == PURSUIT_FORMAT_RG32F) {
		memcpy(row, motion, 8 * (size_t)width);
		return;
	}
	for (uint32_t i = 0; i < 2 * width; i++) {
		uint16_t half = half_from_float(motion[i]);
		memcpy(row + 2 * (size_t)i, &half, sizeof(half));
	}
}

void pixel_composite(uint8_t *bgra, const uint8_t *ui, uint32_t width)
{
	for (uint32_t x = 0; x < width; x++, bgra += 4, ui += 4) {
		uint32_t clear = 255u - ui[3];
		for (uint32_t channel = 0; channel < 3; channel++) {
			uint32_t code = (255u * ui[channel] + clear * bgra[channel] + 127u) / 255u;
			bgra[channel] = (uint8_t)(code > 255u ? 255u : code);
		}
		bgra[3] = 255;
	}
}

void pixel_shrink(const uint8_t *fine, uint32_t factor, uint32_t width, uint32_t height, uint8_t *bgra)
{
	const size_t stride = 4 * (size_t)width * factor;
	const uint32_t count = factor * factor;
	for (uint32_t y = 0; y < height; y++) {
		for (uint32_t x = 0; x < width; x++, bgra += 4) {
			const uint8_t *block = fine + (size_t)y * factor * stride + 4 * (size_t)x * factor;
			uint32_t sums[4] = {0};
			for (uint32_t i = 0; i < count; i++)
				for (uint32_t channel = 0; channel < 4; channel++)
					sums[channel] += block[i / factor * stride + 4 * (i % factor) + channel];
			for (uint32_t channel = 0; channel < 4; channel++)
				bgra[channel] = (uint8_t)((sums[channel] + count / 2) / count);
		}
	}
}
