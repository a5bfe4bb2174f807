/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/measure/camera.h"

#include <math.h>

/* Degrees of visual angle per second (Daly 1998). */
#define FOLLOWED 70.0
#define LOST 90.0

const double camera_speed_limits[CAMERA_SPEEDS - 1] = {7.5, 15.0, 30.0, 60.0, 120.0, 240.0, 480.0};

/* Mean speed of a path, pixels per window. */
static double path_length(const struct camera_path *path, size_t pixel)
{
	const float *before = path->before + 2 * pixel, *after = path->after + 2 * pixel;
	return hypot((double)(after[0] - before[0]), (double)(after[1] - before[1]));
}

static double smoothstep(double from, double to, double x)
{
	const double t = fmin(fmax((x - from) / (to - from), 0.0), 1.0);
	return t * t * (3.0 - 2.0 * t);
}

void camera_path_damp(const struct camera_path *path, double window_s, double degrees_per_pixel)
{
	const size_t pixels = (size_t)path->width * path->height;
	for (size_t i = 0; i < pixels; i++) {
		const double speed = path_length(path, i) / window_s * degrees_per_pixel;
		if (speed <= FOLLOWED)
			continue;
		const float factor = (float)(1.0 - smoothstep(FOLLOWED, LOST, speed));
		for (size_t axis = 0; axis < 2; axis++) {
			path->before[2 * i + axis] *= factor;
			path->after[2 * i + axis] *= factor;
		}
	}
}

static bool inside(const struct camera_path *path, float x, float y)
{
	return x >= 0.5f && y >= 0.5f && x <= (float)path->width - 0.5f && y <= (float)path->height - 0.5f;
}

void camera_path_valid(const struct camera_path *path, uint8_t *valid)
{
	for (uint32_t j = 0; j < path->height; j++) {
		for (uint32_t i = 0; i < path->width; i++) {
			const size_t pixel = (size_t)j * path->width + i;
			const float *before = path->before + 2 * pixel, *after = path->after + 2 * pixel;
			const float x = (float)i + 0.5f, y = (float)j + 0.5f;
			valid[pixel] = inside(path, x + before[0], y + before[1]) && inside(path, x + after[0], y + after[1]);
		}
	}
}

void camera_expose(const struct camera_path *path, const struct camera_exposure *exposure, light_pixel *camera)
{
	const float s = exposure->moment, forth = (s * s + s) / 2.0f, back = (s * s - s) / 2.0f;
	const uint32_t step = exposure->row_step ? exposure->row_step : 1;
	for (uint32_t j = 0; j < path->height; j += step) {
		const float *before = path->before + 2 * (size_t)j * path->width;
		const float *after = path->after + 2 * (size_t)j * path->width;
		light_pixel *row = camera + (size_t)j * path->width;
		for (uint32_t i = 0; i < path->width; i++) {
			const float x = (float)i + 0.5f + forth * after[2 * i] + back * before[2 * i];
			const float y = (float)j + 0.5f + forth * after[2 * i + 1] + back * before[2 * i + 1];
			row[i] += exposure->weight * light_sample(exposure->picture, path->width, path->height, x, y);
		}
	}
}

void camera_errors_by_speed(const struct camera_path *path, double window_s, const uint8_t *valid,
							const struct picture *seen, const struct picture *truth,
							struct squared_error bins[CAMERA_SPEEDS])
{
	for (uint32_t y = 0; y < path->height; y++) {
		const uint8_t *p = seen->data + y * seen->stride, *q = truth->data + y * truth->stride;
		for (uint32_t x = 0; x < path->width; x++, p += 4, q += 4) {
			const size_t pixel = (size_t)y * path->width + x;
			if (!valid[pixel])
				continue;
			const double speed = path_length(path, pixel) / window_s;
			uint32_t bin = 0;
			while (bin < CAMERA_SPEEDS - 1 && speed > camera_speed_limits[bin])
				bin++;
			const int blue = p[0] - q[0], green = p[1] - q[1], red = p[2] - q[2];
			bins[bin].sum += blue * blue + green * green + red * red;
			bins[bin].count++;
		}
	}
}
