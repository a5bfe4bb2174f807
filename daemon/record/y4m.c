/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/record/y4m.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Weights of R and B in luma; the rest follows. */
struct matrix {
	double red, blue;
};

struct y4m {
	FILE *file;
	char *path;
	uint32_t width, height;
	bool subsampled;
	struct matrix matrix;
	uint8_t *planes; /* Y, Cb, Cr */
};

static int write_error(const struct y4m *y4m, struct error *error)
{
	const int code = errno ? errno : EIO;
	if (code == EPIPE)
		return error_set(error, -EPIPE, "%s: the reader of the video has gone away", y4m->path);
	return error_set(error, -code, "%s: video cannot be written: %s", y4m->path, strerror(code));
}

static size_t chroma_size(const struct y4m *y4m)
{
	if (!y4m->subsampled)
		return (size_t)y4m->width * y4m->height;
	return (size_t)((y4m->width + 1) / 2) * ((y4m->height + 1) / 2);
}

struct y4m *y4m_create(const struct y4m_params *params, struct error *error)
{
	struct y4m *y4m = calloc(1, sizeof(*y4m));
	const uint32_t matrix = params->matrix ? params->matrix : params->height >= 720 ? 709 : 601;
	const bool to_stdout = strcmp(params->path, "-") == 0;
	if (!y4m) {
		error_set(error, -ENOMEM, "%s: out of memory", params->path);
		return NULL;
	}
	y4m->width = params->width;
	y4m->height = params->height;
	y4m->subsampled = params->chroma != 444;
	y4m->matrix = matrix == 709 ? (struct matrix){0.2126, 0.0722} : (struct matrix){0.299, 0.114};
	y4m->path = strdup(to_stdout ? "standard output" : params->path);
	y4m->planes = malloc((size_t)y4m->width * y4m->height + 2 * chroma_size(y4m));
	y4m->file = to_stdout ? stdout : fopen(params->path, "wbe");
	if (!y4m->path || !y4m->planes || !y4m->file) {
		const int code = y4m->file ? ENOMEM : errno;
		error_set(error, -code, "%s: video cannot be created: %s", params->path, strerror(code));
		y4m_destroy(&y4m, &(struct error){""});
		return NULL;
	}
	fprintf(y4m->file, "YUV4MPEG2 W%u H%u F%u:%u Ip A1:1 %s XCOLORRANGE=LIMITED XMATRIX=BT%u\n", y4m->width,
			y4m->height, params->rate, params->rate_scale, y4m->subsampled ? "C420jpeg" : "C444", matrix);
	return y4m;
}

static uint8_t code(double value)
{
	return (uint8_t)(value < 0.0 ? 0.0 : value > 255.0 ? 255.0 : value + 0.5);
}

/* Limited range: luma 16 to 235, chroma 16 to 240. */
static void fill_luma(struct y4m *y4m, const uint8_t *bgra, size_t stride)
{
	const double r = y4m->matrix.red * 219 / 255, b = y4m->matrix.blue * 219 / 255, g = 219.0 / 255 - r - b;
	uint8_t *to = y4m->planes;
	for (uint32_t y = 0; y < y4m->height; y++)
		for (uint32_t x = 0; x < y4m->width; x++) {
			const uint8_t *p = bgra + y * stride + 4 * (size_t)x;
			*to++ = code(16.0 + r * p[2] + g * p[1] + b * p[0]);
		}
}

/* Mean of the pixels that share one chroma sample, at the picture's edge of those that there are. */
static void mean_pixel(const struct y4m *y4m, const uint8_t *bgra, size_t stride, uint32_t x, uint32_t y,
					   double mean[3])
{
	const uint32_t step = y4m->subsampled ? 2 : 1;
	uint32_t sum[3] = {0}, count = 0;
	for (uint32_t j = y * step; j < (y + 1) * step && j < y4m->height; j++)
		for (uint32_t i = x * step; i < (x + 1) * step && i < y4m->width; i++, count++)
			for (uint32_t c = 0; c < 3; c++)
				sum[c] += bgra[j * stride + 4 * (size_t)i + c];
	for (uint32_t c = 0; c < 3; c++)
		mean[c] = (double)sum[c] / count;
}

static void fill_chroma(struct y4m *y4m, const uint8_t *bgra, size_t stride)
{
	const struct matrix m = y4m->matrix;
	const uint32_t step = y4m->subsampled ? 2 : 1;
	const uint32_t columns = (y4m->width + step - 1) / step, rows = (y4m->height + step - 1) / step;
	uint8_t *cb = y4m->planes + (size_t)y4m->width * y4m->height, *cr = cb + chroma_size(y4m);
	for (uint32_t y = 0; y < rows; y++)
		for (uint32_t x = 0; x < columns; x++) {
			double p[3];
			mean_pixel(y4m, bgra, stride, x, y, p);
			const double luma = m.red * p[2] + (1.0 - m.red - m.blue) * p[1] + m.blue * p[0];
			*cb++ = code(128.0 + (p[0] - luma) / (2.0 * (1.0 - m.blue)) * 224 / 255);
			*cr++ = code(128.0 + (p[2] - luma) / (2.0 * (1.0 - m.red)) * 224 / 255);
		}
}

int y4m_frame(struct y4m *y4m, const uint8_t *bgra, size_t stride, struct error *error)
{
	const size_t bytes = (size_t)y4m->width * y4m->height + 2 * chroma_size(y4m);
	fill_luma(y4m, bgra, stride);
	fill_chroma(y4m, bgra, stride);
	errno = 0;
	if (fputs("FRAME\n", y4m->file) == EOF || fwrite(y4m->planes, 1, bytes, y4m->file) != bytes)
		return write_error(y4m, error);
	return 0;
}

int y4m_destroy(struct y4m **y4m, struct error *error)
{
	struct y4m *y = *y4m;
	int result = 0;
	if (!y)
		return 0;
	*y4m = NULL;
	errno = 0;
	if (y->file && (ferror(y->file) || fflush(y->file) != 0))
		result = write_error(y, error);
	if (y->file && y->file != stdout && fclose(y->file) != 0 && result == 0)
		result = write_error(y, error);
	free(y->path);
	free(y->planes);
	free(y);
	return result;
}
