/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Low-frequency layer, blur weight and tears, compensation (docs/method.md, 4 to 6; Didyk et al. 2010, 5.1, 6). */
#include "reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint8_t *texel(const struct reference_picture *picture, long i, long j)
{
	const long width = (long)picture->width, height = (long)picture->height;
	i = i < 0 ? 0 : i >= width ? width - 1 : i;
	j = j < 0 ? 0 : j >= height ? height - 1 : j;
	return &picture->data[(j * width + i) * 4];
}

void reference_reduce(struct reference_picture *out, const struct reference_picture *in, double bias)
{
	static const double w[3] = {0.25, 0.5, 0.25};
	reference_picture_init(out, (in->width + 1) / 2, (in->height + 1) / 2);
	for (long j = 0; j < (long)out->height; j++)
		for (long i = 0; i < (long)out->width; i++)
			for (int c = 0; c < 4; c++) {
				double sum = 0.0;
				for (int b = -1; b <= 1; b++)
					for (int a = -1; a <= 1; a++)
						sum += w[a + 1] * w[b + 1] * texel(in, 2 * i + a, 2 * j + b)[c];
				out->data[(j * (long)out->width + i) * 4 + c] = reference_code8(sum / 255.0, bias);
			}
}

void reference_spline_weights(double f, double w[4])
{
	w[0] = (1.0 - f) * (1.0 - f) * (1.0 - f) / 6.0;
	w[1] = (3.0 * f * f * f - 6.0 * f * f + 4.0) / 6.0;
	w[2] = (-3.0 * f * f * f + 3.0 * f * f + 3.0 * f + 1.0) / 6.0;
	w[3] = f * f * f / 6.0;
}

static void reconstruct(struct reference_picture *out, const struct reference_picture *level, double scale, double bias)
{
	for (long y = 0; y < (long)out->height; y++)
		for (long x = 0; x < (long)out->width; x++) {
			const double tx = (double)x / scale, ty = (double)y / scale;
			const long i = (long)floor(tx), j = (long)floor(ty);
			double wx[4], wy[4];
			reference_spline_weights(tx - (double)i, wx);
			reference_spline_weights(ty - (double)j, wy);
			for (int c = 0; c < 4; c++) {
				double sum = 0.0;
				for (int b = 0; b < 4; b++)
					for (int a = 0; a < 4; a++)
						sum += wx[a] * wy[b] * texel(level, i + a - 1, j + b - 1)[c];
				out->data[(y * (long)out->width + x) * 4 + c] = reference_code8(sum / 255.0, bias);
			}
		}
}

void reference_low(struct reference_picture *out, const struct reference_picture *picture, uint32_t level, double bias)
{
	struct reference_picture now = {0}, next = {0};
	reference_picture_init(&now, picture->width, picture->height);
	memcpy(now.data, picture->data, (size_t)picture->width * picture->height * 4);
	for (uint32_t k = 0; k < level; k++) {
		reference_reduce(&next, &now, bias);
		reference_picture_finish(&now);
		now = next;
		next = (struct reference_picture){0};
	}
	reference_picture_init(out, picture->width, picture->height);
	reconstruct(out, &now, ldexp(1.0, (int)level), bias);
	reference_picture_finish(&now);
}

double reference_weight_of(double stretch)
{
	return reference_smoothstep(0.25, 1.0, stretch - 1.0);
}

double reference_tear_of(double stretch)
{
	return reference_smoothstep(1.0, 2.0, stretch - 1.0);
}

double reference_weight(const struct reference_grid *grid, const uint32_t v[3], double last_phase,
						enum engine_blur blur)
{
	double sigma[2];
	if (blur == ENGINE_BLUR_OFF)
		return 0.0;
	if (blur == ENGINE_BLUR_EVERYWHERE)
		return 1.0;
	if (!(reference_area2(grid, v, last_phase) > 0.0))
		return 0.0;
	reference_singular(grid, v, last_phase, sigma);
	return reference_weight_of(sigma[0]);
}

double reference_tear(const struct reference_grid *grid, const uint32_t v[3], double phase, enum engine_blur blur)
{
	double sigma[2];
	if (blur == ENGINE_BLUR_OFF)
		return 0.0;
	reference_singular(grid, v, phase, sigma);
	return reference_tear_of(sigma[0]);
}

void reference_split(double o, double l, uint32_t n, double *b, double *e)
{
	if (n <= 1)
		*b = o;
	else
		*b = fmin(o, fmax(l, (n * o - 1.0) / (n - 1.0)));
	*e = n * o - (n - 1.0) * *b;
}

void reference_compensate(const struct reference_compensation *compensation, double c, double low, double w,
						  double *between, double *real)
{
	const struct reference_transfer *display = &compensation->display;
	const double mix = (1.0 - w) * c + w * low;
	if (w == 0.0) {
		*between = *real = c;
		return;
	}
	if (compensation->off) {
		*between = mix;
		*real = c;
		return;
	}
	const double o = reference_to_light(display, c), l = reference_to_light(display, mix);
	double b, e;
	reference_split(o, l, compensation->n, &b, &e);
	/* o + k (b - o), written so that a dark b beside a bright o keeps its digits. */
	const double k = compensation->k;
	*between = reference_from_light(display, (1.0 - k) * o + k * b);
	*real = reference_from_light(display, (1.0 - k) * o + k * e);
}
