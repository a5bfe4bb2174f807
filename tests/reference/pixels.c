/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "pixels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void reference_steps_init(struct reference_steps *steps, uint32_t width, uint32_t height)
{
	reference_steps_finish(steps);
	steps->width = width;
	steps->height = height;
	steps->values = reference_alloc((size_t)width * height, 3 * sizeof(double));
	steps->open = reference_alloc((size_t)width * height, 1);
}

void reference_steps_finish(struct reference_steps *steps)
{
	free(steps->values);
	free(steps->open);
	*steps = (struct reference_steps){0};
}

/* ---- 9.5: which source where ---- */

static bool near_whole(double x)
{
	return fabs(x - round(x)) < PIXELS_OPEN;
}

/* A source that may come to a pixel instead of the one that does. */
static void mark_rivals(const struct reference_geometry *geometry, double phase, const int64_t *source, uint8_t *open)
{
	const long width = (long)geometry->width, height = (long)geometry->height;
	for (long at = 0; at < width * height; at++) {
		const double x = (double)(at % width) + 0.5 + phase * geometry->ux[at];
		const double y = (double)(at / width) + 0.5 + phase * geometry->uy[at];
		/* All pixels within reach of rounding. */
		for (int k = 0; k < 4; k++) {
			const double tx = floor(x + (k & 1 ? PIXELS_OPEN : -PIXELS_OPEN));
			const double ty = floor(y + (k & 2 ? PIXELS_OPEN : -PIXELS_OPEN));
			if (!(tx >= 0.0 && ty >= 0.0 && tx < (double)width && ty < (double)height))
				continue;
			const size_t target = (size_t)ty * (size_t)width + (size_t)tx;
			const bool moved = tx != floor(x) || ty != floor(y);
			if (source[target] == at) {
				/* It may have gone elsewhere. */
				open[target] |= near_whole(x) || near_whole(y);
				continue;
			}
			if (source[target] < 0) {
				open[target] = 1;
				continue;
			}
			const double shown = geometry->z[source[target]], own = geometry->z[at];
			if (moved ? own <= shown + PIXELS_OPEN_DEPTH : own != shown && fabs(own - shown) < PIXELS_OPEN_DEPTH)
				open[target] = 1;
		}
	}
}

void reference_scatter(const struct reference_geometry *geometry, double phase, int64_t *source, uint8_t *open)
{
	const size_t width = geometry->width, count = width * geometry->height;
	for (size_t at = 0; at < count; at++) {
		source[at] = -1;
		open[at] = 0;
	}
	for (size_t at = 0; at < count; at++) {
		const double x = floor((double)(at % width) + 0.5 + phase * geometry->ux[at]);
		const double y = floor((double)(at / width) + 0.5 + phase * geometry->uy[at]);
		if (x < 0.0 || y < 0.0 || x >= (double)width || y >= (double)geometry->height)
			continue;
		int64_t *there = &source[(size_t)y * width + (size_t)x];
		if (*there < 0 || geometry->z[at] < geometry->z[*there])
			*there = (int64_t)at;
	}
	mark_rivals(geometry, phase, source, open);
}

/* ---- 9.5: pull-push ---- */

static double channel(const double *values, uint32_t width, uint32_t channels, uint32_t i, uint32_t j, uint32_t c)
{
	return values[((size_t)j * width + i) * channels + c];
}

static uint32_t clamped(long i, uint32_t size)
{
	return i < 0 ? 0 : i >= (long)size ? size - 1 : (uint32_t)i;
}

void reference_fill(double *values, const uint8_t *valid, uint32_t width, uint32_t height, uint32_t channels)
{
	if (width == 1 && height == 1) {
		for (uint32_t c = 0; c < channels && !valid[0]; c++)
			values[c] = 0.0;
		return;
	}
	const uint32_t half_width = (width + 1) / 2, half_height = (height + 1) / 2;
	double *above = reference_alloc((size_t)half_width * half_height * channels, sizeof(double));
	uint8_t *there = reference_alloc((size_t)half_width * half_height, 1);
	double *counts = reference_alloc((size_t)half_width * half_height, sizeof(double));
	for (uint32_t j = 0; j < height; j++)
		for (uint32_t i = 0; i < width; i++) {
			const size_t parent = (size_t)(j / 2) * half_width + i / 2;
			if (!valid[(size_t)j * width + i])
				continue;
			there[parent] = 1;
			counts[parent] += 1.0;
			for (uint32_t c = 0; c < channels; c++)
				above[parent * channels + c] += channel(values, width, channels, i, j, c);
		}
	for (size_t i = 0; i < (size_t)half_width * half_height * channels; i++)
		above[i] /= fmax(counts[i / channels], 1.0);
	reference_fill(above, there, half_width, half_height, channels);
	for (uint32_t j = 0; j < height; j++)
		for (uint32_t i = 0; i < width; i++) {
			if (valid[(size_t)j * width + i])
				continue;
			const uint32_t x0 = i / 2, x1 = clamped(i % 2 ? (long)x0 + 1 : (long)x0 - 1, half_width);
			const uint32_t y0 = j / 2, y1 = clamped(j % 2 ? (long)y0 + 1 : (long)y0 - 1, half_height);
			for (uint32_t c = 0; c < channels; c++)
				values[((size_t)j * width + i) * channels + c] =
					(9.0 * channel(above, half_width, channels, x0, y0, c) +
					 3.0 * channel(above, half_width, channels, x1, y0, c) +
					 3.0 * channel(above, half_width, channels, x0, y1, c) +
					 channel(above, half_width, channels, x1, y1, c)) /
					16.0;
		}
	free(above);
	free(there);
	free(counts);
}

/* ---- 9.4 ---- */

void reference_mcif(const struct reference_geometry *geometry, const struct reference_picture *original,
					struct reference_steps *out)
{
	reference_steps_init(out, original->width, original->height);
	for (size_t at = 0; at < (size_t)original->width * original->height; at++) {
		const double ux = geometry->ux[at], uy = geometry->uy[at], length = hypot(ux, uy);
		const double x = (double)(at % original->width) + 0.5, y = (double)(at / original->width) + 0.5;
		const double n = fmin(16.0, fmax(1.0, ceil(length)));
		double mean[3] = {0.0, 0.0, 0.0};
		for (double k = 0.0; k < n; k += 1.0) {
			const double s = (k + 0.5) / n - 0.5;
			double sample[3];
			reference_sample(original, x + s * ux, y + s * uy, sample);
			for (int c = 0; c < 3; c++)
				mean[c] += sample[c] / n;
		}
		for (int c = 0; c < 3; c++) {
			const double own = original->data[4 * at + (size_t)c];
			out->values[3 * at + (size_t)c] = length > 0.0 ? own + (own - mean[c]) : own;
		}
		out->open[at] = length < 16.0 && length > 0.5 && near_whole(length);
	}
}

/* ---- 9.5: the picture ---- */

/* What is filled from open pixels is open too. `valid`: as for reference_fill(). */
static void spread_open(const uint8_t *valid, uint8_t *open, uint32_t width, uint32_t height)
{
	if (width == 1 && height == 1)
		return;
	const uint32_t half_width = (width + 1) / 2, half_height = (height + 1) / 2;
	uint8_t *there = reference_alloc((size_t)half_width * half_height, 1);
	uint8_t *above = reference_alloc((size_t)half_width * half_height, 1);
	for (uint32_t j = 0; j < height; j++)
		for (uint32_t i = 0; i < width; i++) {
			const size_t at = (size_t)j * width + i, parent = (size_t)(j / 2) * half_width + i / 2;
			there[parent] |= valid[at];
			above[parent] |= open[at];
		}
	spread_open(there, above, half_width, half_height);
	for (uint32_t j = 0; j < height; j++)
		for (uint32_t i = 0; i < width; i++) {
			const uint32_t x1 = clamped((long)(i / 2) + (i % 2 ? 1 : -1), half_width);
			const uint32_t y1 = clamped((long)(j / 2) + (j % 2 ? 1 : -1), half_height);
			if (!valid[(size_t)j * width + i])
				open[(size_t)j * width + i] |=
					above[(size_t)(j / 2) * half_width + i / 2] | above[(size_t)(j / 2) * half_width + x1] |
					above[(size_t)y1 * half_width + i / 2] | above[(size_t)y1 * half_width + x1];
		}
	free(there);
	free(above);
}

void reference_scattered(const struct reference_geometry *geometry, const struct reference_picture *original,
						 double phase, struct reference_steps *out)
{
	const size_t width = original->width, count = width * original->height;
	int64_t *source = reference_alloc(count, sizeof(*source));
	uint8_t *valid = reference_alloc(count, 1);
	bool any = false;
	reference_steps_init(out, original->width, original->height);
	reference_scatter(geometry, phase, source, out->open);
	for (size_t at = 0; at < count; at++) {
		valid[at] = source[at] >= 0;
		any |= valid[at] != 0;
		if (valid[at])
			reference_sample(original, (double)(at % width) + 0.5 - phase * geometry->ux[source[at]],
							 (double)(at / width) + 0.5 - phase * geometry->uy[source[at]], &out->values[3 * at]);
	}
	spread_open(valid, out->open, original->width, original->height);
	if (any)
		reference_fill(out->values, valid, original->width, original->height, 3);
	for (size_t at = 0; at < count && !any; at++)
		for (size_t c = 0; c < 3; c++)
			out->values[3 * at + c] = original->data[4 * at + c];
	free(source);
	free(valid);
}

/* ---- 9.6 ---- */

static size_t pixel_of(double x, double y, uint32_t width, uint32_t height)
{
	return (size_t)clamped((long)floor(y), height) * width + clamped((long)floor(x), width);
}

/* Whether something nearer was there then, by how much more than needed. */
static double nearer_by(const struct reference_geometry *before, size_t there, double z)
{
	return 1.0 - before->z[there] - (1.05 * (1.0 - z) + 0.001);
}

static void mix(const struct reference_geometry *geometry, const struct reference_picture *original,
				const struct reference_geometry *before, const struct reference_picture *previous, double share,
				const double u[2], size_t at, int64_t source, struct reference_steps *out)
{
	const double x = (double)(at % geometry->width) + 0.5, y = (double)(at / geometry->width) + 0.5;
	const double px = x - share * u[0], py = y - share * u[1];
	double now[3], then[3], weight = source < 0 ? 0.0 : share;
	reference_sample(original, x - (share - 1.0) * u[0], y - (share - 1.0) * u[1], now);
	reference_sample(previous, px, py, then);
	if (source >= 0) {
		const double by = nearer_by(before, pixel_of(px, py, geometry->width, geometry->height), geometry->z[source]);
		weight = by > 0.0 ? 1.0 : share;
		out->open[at] |= near_whole(px) || near_whole(py) || fabs(by) < 1e-5;
	}
	for (size_t c = 0; c < 3; c++)
		out->values[3 * at + c] = weight * now[c] + (1.0 - weight) * then[c];
}

void reference_interpolated(const struct reference_geometry *geometry, const struct reference_picture *original,
							const struct reference_geometry *before, const struct reference_picture *previous,
							double share, struct reference_steps *out)
{
	const size_t count = (size_t)original->width * original->height;
	int64_t *source = reference_alloc(count, sizeof(*source));
	uint8_t *valid = reference_alloc(count, 1);
	double *u = reference_alloc(count, 2 * sizeof(double));
	reference_steps_init(out, original->width, original->height);
	reference_scatter(geometry, share - 1.0, source, out->open);
	for (size_t at = 0; at < count; at++) {
		valid[at] = source[at] >= 0;
		u[2 * at] = valid[at] ? geometry->ux[source[at]] : 0.0;
		u[2 * at + 1] = valid[at] ? geometry->uy[source[at]] : 0.0;
	}
	spread_open(valid, out->open, original->width, original->height);
	reference_fill(u, valid, original->width, original->height, 2);
	for (size_t at = 0; at < count; at++)
		mix(geometry, original, before, previous, share, &u[2 * at], at, source[at], out);
	free(source);
	free(valid);
	free(u);
}
