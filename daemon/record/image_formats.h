/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What the image formats share; private to image*.c. */
#ifndef PURSUIT_IMAGE_FORMATS_H
#define PURSUIT_IMAGE_FORMATS_H

#include <stdio.h>

#include "daemon/record/image.h"

/* Readers of one format. PNG can yield either kind, the others only values. The file is at its start. */
int image_read_png(const char *path, FILE *file, enum image_want want, uint64_t memory_limit, struct image *image,
				   struct error *error);
int image_read_pfm(const char *path, FILE *file, uint64_t memory_limit, struct image *image, struct error *error);
/* For IMAGE_BGRA the channels are R, G, B, A as far as there are any. */
int image_read_exr(const char *path, enum image_want want, uint64_t memory_limit, struct image *image,
				   struct error *error);

/* Checks the sides and allocates; `bytes` is of one pixel in memory, all copies that are held at once together. */
int image_check_size(const char *path, uint64_t width, uint64_t height, uint64_t bytes, uint64_t memory_limit,
					 struct error *error);
int image_out_of_memory(const char *path, struct error *error);

/* Closes a file that was written; a full disk may be told only here. */
int image_close_written(const char *path, FILE *file, struct error *error);

#endif
