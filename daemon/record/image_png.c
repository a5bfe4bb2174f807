/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/record/image_formats.h"
#include "proto/frame.h"

/* Ancillary chunks, such as text, are not for us. */
#define MAX_CHUNK_BYTES ((png_alloc_size_t)8 << 20)

/*
 * All that libpng's longjmp could leak lies here, and only the function that
 * owns the job frees it. Nothing that changes after a setjmp is a local.
 */
struct png_job {
	const char *path;
	struct error *error;
	uint64_t memory_limit;
	int result;
	png_struct *png;
	png_info *info;
	uint8_t *pixels; /* as libpng gives them */
	uint8_t **rows;
	uint32_t width, height, channels, bits;
	size_t row_bytes;
	bool alpha;         /* of the file */
	int level, filters; /* of what is written */
};

static void on_error(png_struct *png, const char *message)
{
	struct png_job *job = png_get_error_ptr(png);
	if (job->result == 0)
		job->result = error_set(job->error, -EBADMSG, "%s: PNG: %s", job->path, message);
	longjmp(png_jmpbuf(png), 1);
}

static void on_warning(png_struct *png, const char *message)
{
}

static void finish_job(struct png_job *job, bool writing)
{
	if (writing)
		png_destroy_write_struct(&job->png, &job->info);
	else
		png_destroy_read_struct(&job->png, &job->info, NULL);
	free(job->pixels);
	free(job->rows);
}

static int allocate_rows(struct png_job *job)
{
	job->rows = malloc(sizeof(job->rows[0]) * job->height);
	if (!job->pixels)
		job->pixels = malloc(job->row_bytes * job->height);
	if (!job->rows || !job->pixels)
		return image_out_of_memory(job->path, job->error);
	for (uint32_t y = 0; y < job->height; y++)
		job->rows[y] = job->pixels + y * job->row_bytes;
	return 0;
}

/* ---- reading ---- */

/* Palette, low depths and key colours become plain samples; colour ends as BGRA8, numbers keep their depth. */
static void set_transforms(struct png_job *job, enum image_want want)
{
	png_set_expand(job->png);
	if (want == IMAGE_BGRA) {
		png_set_scale_16(job->png);
		png_set_gray_to_rgb(job->png);
		png_set_bgr(job->png);
		png_set_add_alpha(job->png, 255, PNG_FILLER_AFTER);
	} else {
		png_set_swap(job->png);
	}
	png_set_interlace_handling(job->png);
	png_read_update_info(job->png, job->info);
}

static void decode(struct png_job *job, FILE *file, enum image_want want)
{
	if (setjmp(png_jmpbuf(job->png)))
		return;
	png_init_io(job->png, file);
	png_set_user_limits(job->png, 0x7fffffff, 0x7fffffff);
	png_set_chunk_malloc_max(job->png, MAX_CHUNK_BYTES);
	png_read_info(job->png, job->info);
	job->width = png_get_image_width(job->png, job->info);
	job->height = png_get_image_height(job->png, job->info);
	/* 8 bytes: RGBA of 16 bits; 16 more for what is made of them. */
	job->result = image_check_size(job->path, job->width, job->height, want == IMAGE_BGRA ? 4 : 24, job->memory_limit,
								   job->error);
	if (job->result < 0)
		return;
	job->alpha = (png_get_color_type(job->png, job->info) & PNG_COLOR_MASK_ALPHA) ||
				 png_get_valid(job->png, job->info, PNG_INFO_tRNS);
	set_transforms(job, want);
	job->channels = png_get_channels(job->png, job->info);
	job->bits = png_get_bit_depth(job->png, job->info);
	job->row_bytes = png_get_rowbytes(job->png, job->info);
	job->result = allocate_rows(job);
	if (job->result < 0)
		return;
	png_read_image(job->png, job->rows);
	png_read_end(job->png, NULL);
}

static int take_values(const struct png_job *job, struct image *image)
{
	const size_t count = (size_t)job->width * job->channels;
	image->scale = job->bits == 16 ? 65535.0f : 255.0f;
	image->channels = job->channels;
	image->values = malloc(sizeof(float) * count * job->height);
	if (!image->values)
		return image_out_of_memory(job->path, job->error);
	for (uint32_t y = 0; y < job->height; y++) {
		float *to = image->values + y * count;
		const uint16_t *wide = (const uint16_t *)(const void *)job->rows[y];
		for (size_t i = 0; i < count; i++)
			to[i] = (job->bits == 16 ? (float)wide[i] : (float)job->rows[y][i]) / image->scale;
	}
	return 0;
}

int image_read_png(const char *path, FILE *file, enum image_want want, uint64_t memory_limit, struct image *image,
				   struct error *error)
{
	struct png_job job = {.path = path, .error = error, .memory_limit = memory_limit};
	job.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
	job.info = job.png ? png_create_info_struct(job.png) : NULL;
	if (job.info)
		decode(&job, file, want);
	else
		job.result = image_out_of_memory(path, error);
	if (job.result == 0) {
		image->width = job.width;
		image->height = job.height;
		image->has_alpha = job.alpha;
		if (want == IMAGE_BGRA) {
			image->channels = 4;
			image->bgra = job.pixels;
			job.pixels = NULL;
		} else {
			job.result = take_values(&job, image);
		}
	}
	finish_job(&job, false);
	return job.result;
}

/* ---- writing ---- */

static void encode(struct png_job *job, FILE *file)
{
	const bool alpha = job->alpha;
	if (setjmp(png_jmpbuf(job->png)))
		return;
	png_init_io(job->png, file);
	png_set_compression_level(job->png, job->level);
	png_set_filter(job->png, PNG_FILTER_TYPE_BASE, job->filters);
	png_set_IHDR(job->png, job->info, job->width, job->height, 8, alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB,
				 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	png_set_sRGB(job->png, job->info, PNG_sRGB_INTENT_PERCEPTUAL);
	png_write_info(job->png, job->info);
	png_set_bgr(job->png);
	if (!alpha)
		png_set_filler(job->png, 0, PNG_FILLER_AFTER);
	png_write_image(job->png, job->rows);
	png_write_end(job->png, NULL);
}

static int write_png(struct png_job *job, const uint8_t *bgra)
{
	FILE *file = fopen(job->path, "wbe");
	if (!file)
		return error_set(job->error, -errno, "%s: cannot be created: %s", job->path, strerror(errno));
	job->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, job, on_error, on_warning);
	job->info = job->png ? png_create_info_struct(job->png) : NULL;
	job->rows = malloc(sizeof(job->rows[0]) * job->height);
	if (job->info && job->rows) {
		for (uint32_t y = 0; y < job->height; y++)
			job->rows[y] = (uint8_t *)(uintptr_t)bgra + y * job->row_bytes;
		encode(job, file);
	} else {
		job->result = image_out_of_memory(job->path, job->error);
	}
	finish_job(job, true);
	const int closed = image_close_written(job->path, file, job->error);
	return closed < 0 ? closed : job->result;
}

int image_write_png(const char *path, const uint8_t *bgra, size_t stride, uint32_t width, uint32_t height, bool alpha,
					struct error *error)
{
	struct png_job job = {
		.path = path,
		.error = error,
		.width = width,
		.height = height,
		.row_bytes = stride,
		.alpha = alpha,
		.level = 1,
		.filters = PNG_FILTER_SUB,
	};
	return write_png(&job, bgra);
}

int image_write_png_small(const char *path, const uint8_t *bgra, uint32_t width, uint32_t height, bool differences,
						  struct error *error)
{
	struct png_job job = {
		.path = path,
		.error = error,
		.width = width,
		.height = height,
		.row_bytes = 4 * (size_t)width,
		.level = 9,
		.filters = differences ? PNG_FILTER_NONE : PNG_ALL_FILTERS,
	};
	return write_png(&job, bgra);
}
