/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * An image from anywhere: PNG, PFM, OpenEXR. Input: a byte of choices, then the
 * file. One of the choices makes the checksums of a PNG's chunks right.
 */
#include <stdlib.h>
#include <string.h>

#include "daemon/record/image.h"
#include "tests/fuzz/fuzz.h"

#define MEMORY_LIMIT ((uint64_t)4 << 20)
#define PNG_SIGNATURE 8u

enum choices {
	WANT_VALUES = 1,
	SEAL_PNG = 2,
};

static uint32_t crc32_of(const uint8_t *data, size_t size)
{
	uint32_t crc = UINT32_MAX;
	for (size_t i = 0; i < size; i++) {
		crc ^= data[i];
		for (int bit = 0; bit < 8; bit++)
			crc = crc >> 1 ^ (crc & 1 ? UINT32_C(0xedb88320) : 0);
	}
	return ~crc;
}

static uint32_t load_big(const uint8_t *from)
{
	return (uint32_t)from[0] << 24 | (uint32_t)from[1] << 16 | (uint32_t)from[2] << 8 | from[3];
}

static void store_big(uint8_t *to, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		to[i] = (uint8_t)(value >> (24 - 8 * i));
}

/* Length, type, data, checksum of type and data. */
static void seal_png(uint8_t *file, size_t size)
{
	size_t at = PNG_SIGNATURE;
	while (size >= 12 && at <= size - 12) {
		const size_t length = load_big(file + at);
		if (length > size - at - 12)
			return;
		store_big(file + at + 8 + length, crc32_of(file + at + 4, length + 4));
		at += length + 12;
	}
}

int fuzz_one(const uint8_t *data, size_t size)
{
	struct fuzz_input input = {data, size};
	struct fuzz_file file;
	struct image image;
	struct error error = {""};
	const int open_fds = fuzz_open_fds();
	const uint8_t choices = fuzz_u8(&input);
	uint8_t *copy = malloc(input.size + 1);

	FUZZ_EXPECT(copy != NULL);
	memcpy(copy, input.data, input.size);
	if (choices & SEAL_PNG)
		seal_png(copy, input.size);
	fuzz_file_init(&file, copy, input.size);
	const enum image_want want = choices & WANT_VALUES ? IMAGE_VALUES : IMAGE_BGRA;
	if (image_read(file.path, want, MEMORY_LIMIT, &image, &error) == 0) {
		const size_t pixels = (size_t)image.width * image.height;
		FUZZ_EXPECT(pixels > 0 && image.channels >= 1 && image.channels <= 4);
		FUZZ_EXPECT((image.values != NULL) == (want == IMAGE_VALUES) && (image.bgra != NULL) == (want == IMAGE_BGRA));
		if (want == IMAGE_VALUES)
			fuzz_touch((const uint8_t *)image.values, pixels * image.channels * sizeof(float));
		else
			fuzz_touch(image.bgra, pixels * 4);
		image_finish(&image);
	} else {
		FUZZ_EXPECT(error.text[0]);
	}
	fuzz_file_finish(&file);
	free(copy);
	FUZZ_EXPECT(fuzz_open_fds() == open_fds);
	return 0;
}
