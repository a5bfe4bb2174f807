/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/record/image.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/record/image_formats.h"
#include "proto/frame.h"

#define DEFAULT_LIMIT ((uint64_t)1 << 30)

int image_out_of_memory(const char *path, struct error *error)
{
	return error_set(error, -ENOMEM, "%s: out of memory", path);
}

int image_check_size(const char *path, uint64_t width, uint64_t height, uint64_t bytes, uint64_t memory_limit,
					 struct error *error)
{
	if (width < 1 || width > PURSUIT_MAX_SIZE)
		return error_set(error, -EBADMSG, "%s: width is %" PRIu64 ", must be 1 to %u", path, width, PURSUIT_MAX_SIZE);
	if (height < 1 || height > PURSUIT_MAX_SIZE)
		return error_set(error, -EBADMSG, "%s: height is %" PRIu64 ", must be 1 to %u", path, height, PURSUIT_MAX_SIZE);
	if (width * height * bytes > memory_limit)
		return error_set(error, -ENOMEM,
						 "%s: size is %" PRIu64 "x%" PRIu64 ", must fit %" PRIu64 " bytes (memory limit)", path, width,
						 height, memory_limit);
	return 0;
}

int image_close_written(const char *path, FILE *file, struct error *error)
{
	const bool bad = ferror(file) != 0;
	const int code = errno;
	if (fclose(file) == 0 && !bad)
		return 0;
	return error_set(error, bad && code ? -code : -errno, "%s: cannot be written: %s", path,
					 strerror(bad && code ? code : errno));
}

uint8_t image_encode_srgb(float light)
{
	if (!(light > 0.0f))
		return 0;
	if (light >= 1.0f)
		return 255;
	const float code = light <= 0.0031308f ? 12.92f * light : 1.055f * powf(light, 1.0f / 2.4f) - 0.055f;
	return (uint8_t)(code * 255.0f + 0.5f);
}

/* Linear values of 1 to 4 channels (grey, two, RGB, RGBA) to sRGB codes. */
static int encode(const char *path, struct image *image, struct error *error)
{
	const uint64_t count = (uint64_t)image->width * image->height;
	const uint32_t channels = image->channels;
	uint8_t *bgra = malloc(count * 4);
	if (!bgra) {
		image_finish(image);
		return image_out_of_memory(path, error);
	}
	for (uint64_t i = 0; i < count; i++) {
		const float *from = image->values + i * channels;
		uint8_t *to = bgra + 4 * i;
		to[2] = image_encode_srgb(from[0]);
		to[1] = channels > 1 ? image_encode_srgb(from[1]) : to[2];
		to[0] = channels > 2 ? image_encode_srgb(from[2]) : channels > 1 ? 0 : to[2];
		to[3] = channels > 3 ? (uint8_t)(fminf(fmaxf(from[3], 0.0f), 1.0f) * 255.0f + 0.5f) : 255;
	}
	free(image->values);
	image->values = NULL;
	image->bgra = bgra;
	image->has_alpha = channels == 4;
	image->premultiplied = channels == 4;
	image->channels = 4;
	return 0;
}

static int read_values(const char *path, FILE *file, const uint8_t magic[8], enum image_want want, uint64_t limit,
					   struct image *image, struct error *error)
{
	static const uint8_t exr[4] = {0x76, 0x2f, 0x31, 0x01};
	int result;
	if (memcmp(magic, exr, sizeof(exr)) == 0)
		result = image_read_exr(path, want, limit, image, error);
	else if (magic[0] == 'P' && (magic[1] == 'F' || magic[1] == 'f'))
		result = image_read_pfm(path, file, limit, image, error);
	else
		return error_set(error, -EBADMSG,
						 "%s: format is unknown, must be PNG, PFM or OpenEXR (first bytes %02x %02x %02x %02x)", path,
						 magic[0], magic[1], magic[2], magic[3]);
	return result == 0 && want == IMAGE_BGRA ? encode(path, image, error) : result;
}

static int open_regular(const char *path, FILE **file, struct error *error)
{
	struct stat stat;
	/* Not to hang on a pipe. */
	const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (fd < 0)
		return error_set(error, -errno, "%s: cannot be opened: %s", path, strerror(errno));
	if (fstat(fd, &stat) < 0 || !S_ISREG(stat.st_mode)) {
		close(fd);
		return error_set(error, -EINVAL, "%s: must be a regular file", path);
	}
	*file = fdopen(fd, "rb");
	if (*file)
		return 0;
	close(fd);
	return image_out_of_memory(path, error);
}

int image_read(const char *path, enum image_want want, uint64_t memory_limit, struct image *image, struct error *error)
{
	static const uint8_t png[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
	const uint64_t limit = memory_limit ? memory_limit : DEFAULT_LIMIT;
	uint8_t magic[8] = {0};
	FILE *file = NULL;

	*image = (struct image){.scale = 1.0f};
	int result = open_regular(path, &file, error);
	if (result < 0)
		return result;
	const size_t got = fread(magic, 1, sizeof(magic), file);
	rewind(file);
	if (got < sizeof(magic))
		result = error_set(error, -EBADMSG, "%s: length is %zu bytes, must be an image", path, got);
	else if (memcmp(magic, png, sizeof(png)) == 0)
		result = image_read_png(path, file, want, limit, image, error);
	else
		result = read_values(path, file, magic, want, limit, image, error);
	fclose(file);
	if (result < 0)
		image_finish(image);
	return result;
}

void image_finish(struct image *image)
{
	free(image->values);
	free(image->bgra);
	*image = (struct image){0};
}
