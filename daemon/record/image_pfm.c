/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/record/image_formats.h"

/* Next word of the header and the one white character behind it. False at the end or if it is too long. */
static bool read_word(FILE *file, char *word, size_t size)
{
	size_t length = 0;
	int c;
	do
		c = fgetc(file);
	while (c == ' ' || c == '\t' || c == '\r' || c == '\n');
	for (; c > ' ' && length + 1 < size; c = fgetc(file))
		word[length++] = (char)c;
	word[length] = '\0';
	return length > 0 && (c == ' ' || c == '\t' || c == '\r' || c == '\n');
}

static int read_number(const char *path, FILE *file, const char *field, double *value, struct error *error)
{
	char word[32], *end;
	if (!read_word(file, word, sizeof(word)))
		return error_set(error, -EBADMSG, "%s: %s is missing, must be a number", path, field);
	*value = strtod(word, &end);
	if (*end || !isfinite(*value))
		return error_set(error, -EBADMSG, "%s: %s is '%s', must be a number", path, field, word);
	return 0;
}

static float load_float(const uint8_t *bytes, bool little)
{
	uint32_t bits;
	float value;
	if (little)
		bits = (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
	else
		bits = (uint32_t)bytes[3] | (uint32_t)bytes[2] << 8 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[0] << 24;
	memcpy(&value, &bits, sizeof(value));
	return value;
}

/* Rows run from the bottom up in the file. */
static int read_rows(const char *path, FILE *file, bool little, struct image *image, struct error *error)
{
	const size_t count = (size_t)image->width * image->channels;
	uint8_t *row = malloc(count * 4);
	int result = row ? 0 : image_out_of_memory(path, error);
	for (uint32_t y = image->height; result == 0 && y-- > 0;) {
		if (fread(row, 4, count, file) != count)
			result = error_set(error, -EBADMSG, "%s: row %u of %u is cut off: the file is too short", path,
							   image->height - 1 - y, image->height);
		for (size_t i = 0; result == 0 && i < count; i++)
			image->values[y * count + i] = load_float(row + 4 * i, little);
	}
	free(row);
	return result;
}

int image_read_pfm(const char *path, FILE *file, uint64_t memory_limit, struct image *image, struct error *error)
{
	char magic[4];
	double width, height, scale;

	if (!read_word(file, magic, sizeof(magic)) || (strcmp(magic, "PF") != 0 && strcmp(magic, "Pf") != 0))
		return error_set(error, -EBADMSG, "%s: magic is '%s', must be 'PF' or 'Pf'", path, magic);
	int result = read_number(path, file, "width", &width, error);
	if (result == 0)
		result = read_number(path, file, "height", &height, error);
	if (result == 0)
		result = read_number(path, file, "scale", &scale, error);
	if (result < 0)
		return result;
	if (width != floor(width) || height != floor(height) || width < 0 || height < 0 || width > 1e9 || height > 1e9)
		return error_set(error, -EBADMSG, "%s: size is %gx%g, must be whole numbers above 0", path, width, height);
	if (scale == 0.0)
		return error_set(error, -EBADMSG, "%s: scale is 0, must be negative (little-endian) or positive", path);
	image->channels = magic[1] == 'F' ? 3 : 1;
	result = image_check_size(path, (uint64_t)width, (uint64_t)height, 4 * image->channels, memory_limit, error);
	if (result < 0)
		return result;
	image->width = (uint32_t)width;
	image->height = (uint32_t)height;
	image->values = malloc(sizeof(float) * image->channels * image->width * image->height);
	if (!image->values)
		return image_out_of_memory(path, error);
	return read_rows(path, file, scale < 0.0, image, error);
}

int image_write_pfm(const char *path, const float *values, uint32_t width, uint32_t height, uint32_t channels,
					struct error *error)
{
	const uint32_t stored = channels == 1 ? 1 : 3;
	FILE *file = fopen(path, "wbe");
	if (!file)
		return error_set(error, -errno, "%s: cannot be created: %s", path, strerror(errno));
	/* Little-endian whatever the machine: bytes are put out by value. */
	fprintf(file, "%s\n%u %u\n-1.0\n", stored == 1 ? "Pf" : "PF", width, height);
	uint8_t *row = malloc((size_t)width * stored * 4);
	for (uint32_t y = height; row && !ferror(file) && y-- > 0;) {
		uint8_t *to = row;
		for (uint32_t x = 0; x < width; x++)
			for (uint32_t c = 0; c < stored; c++, to += 4) {
				const float value = c < channels ? values[((size_t)y * width + x) * channels + c] : 0.0f;
				uint32_t bits;
				memcpy(&bits, &value, sizeof(bits));
				for (int i = 0; i < 4; i++)
					to[i] = (uint8_t)(bits >> 8 * i);
			}
		fwrite(row, 4, (size_t)width * stored, file);
	}
	if (!row) {
		fclose(file);
		return image_out_of_memory(path, error);
	}
	free(row);
	return image_close_written(path, file, error);
}
