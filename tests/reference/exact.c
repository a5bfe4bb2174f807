/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "exact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void picture_init(struct exact_picture *picture, uint32_t width, uint32_t height)
{
	*picture = (struct exact_picture){width, height, reference_alloc((size_t)width * height * 3, sizeof(double))};
}

static const double *texel(const struct exact_picture *picture, long i, long j)
{
	const long width = (long)picture->width, height = (long)picture->height;
	i = i < 0 ? 0 : i >= width ? width - 1 : i;
	j = j < 0 ? 0 : j >= height ? height - 1 : j;
	return &picture->data[(j * width + i) * 3];
}

/* The sum of count x count texels from (i, j) on, with separable weights. */
static void sum_texels(const struct exact_picture *picture, long i, long j, const double *wx, const double *wy,
					   int count, double out[3])
{
	out[0] = out[1] = out[2] = 0.0;
	for (int b = 0; b < count; b++)
		for (int a = 0; a < count; a++)
			for (int c = 0; c < 3; c++)
				out[c] += wx[a] * wy[b] * texel(picture, i + a, j + b)[c];
}

static void reduce(struct exact_picture *out, const struct exact_picture *in)
{
	static const double w[3] = {0.25, 0.5, 0.25};
	picture_init(out, (in->width + 1) / 2, (in->height + 1) / 2);
	for (long j = 0; j < (long)out->height; j++)
		for (long i = 0; i < (long)out->width; i++)
			sum_texels(in, 2 * i - 1, 2 * j - 1, w, w, 3, &out->data[(j * (long)out->width + i) * 3]);
}

static void reconstruct(struct exact_picture *out, const struct exact_picture *level, double scale)
{
	for (long y = 0; y < (long)out->height; y++)
		for (long x = 0; x < (long)out->width; x++) {
			const double tx = (double)x / scale, ty = (double)y / scale;
			const long i = (long)floor(tx), j = (long)floor(ty);
			double wx[4], wy[4];
			reference_spline_weights(tx - (double)i, wx);
			reference_spline_weights(ty - (double)j, wy);
			sum_texels(level, i - 1, j - 1, wx, wy, 4, &out->data[(y * (long)out->width + x) * 3]);
		}
}

static void fill_low(struct exact *exact, const struct exact_picture *original)
{
	const uint32_t levels = exact->reference->blur_level;
	struct exact_picture now, next;
	picture_init(&now, original->width, original->height);
	memcpy(now.data, original->data, (size_t)now.width * now.height * 3 * sizeof(double));
	for (uint32_t k = 0; k < levels; k++) {
		reduce(&next, &now);
		free(now.data);
		now = next;
	}
	picture_init(&exact->low, original->width, original->height);
	reconstruct(&exact->low, &now, ldexp(1.0, (int)levels));
	free(now.data);
}

void exact_init(struct exact *exact, const struct reference *reference)
{
	const uint32_t width = reference->width, height = reference->height;
	struct exact_picture original;
	*exact = (struct exact){.reference = reference};
	picture_init(&original, width, height);
	for (size_t i = 0; i < (size_t)width * height * 3; i++)
		original.data[i] = reference->original.data[i / 3 * 4 + i % 3] / 255.0;
	fill_low(exact, &original);
	picture_init(&exact->real, width, height);
	picture_init(&exact->between, width, height);
	for (size_t i = 0; i < (size_t)width * height * 3; i++)
		reference_compensate(&reference->compensation, original.data[i], exact->low.data[i], reference->weight[i / 3],
							 &exact->between.data[i], &exact->real.data[i]);
	free(original.data);
}

void exact_finish(struct exact *exact)
{
	free(exact->low.data);
	free(exact->real.data);
	free(exact->between.data);
	*exact = (struct exact){0};
}

static void sample(const void *data, double x, double y, double out[3])
{
	const struct exact_picture *picture = data;
	const double i = floor(x - 0.5), j = floor(y - 0.5);
	const double fx = x - 0.5 - i, fy = y - 0.5 - j;
	const double wx[2] = {1.0 - fx, fx}, wy[2] = {1.0 - fy, fy};
	sum_texels(picture, (long)i, (long)j, wx, wy, 2, out);
}

static void put(void *data, size_t pixel, const double codes[3])
{
	memcpy((double *)data + pixel * 3, codes, 3 * sizeof(*codes));
}

void exact_render(const struct exact *exact, const struct engine_request *request, double *codes)
{
	const double phase = reference_phase(request);
	const struct exact_picture *picture = request->show == ENGINE_SHOW_REAL ? &exact->real : &exact->between;
	const struct reference *reference = exact->reference;
	if (reference->hold) {
		for (size_t i = 0; i < (size_t)picture->width * picture->height * 3; i++)
			codes[i] = reference->original.data[i / 3 * 4 + i % 3] / 255.0;
	} else if (request->show == ENGINE_SHOW_REAL && phase == 0.0)
		memcpy(codes, picture->data, (size_t)picture->width * picture->height * 3 * sizeof(double));
	else
		reference_mix(reference, phase, &(struct reference_layers){picture, &exact->low, sample, put, codes});
}
