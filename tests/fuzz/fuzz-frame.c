/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A frame header from anywhere: what frame_validate() lets through can be laid
 * out, packed and read without leaving the memory that it was checked against.
 * Input: a number (bytes for planes), then pairs of an offset and a number that
 * are written over a good header; or, if the first bit is set, a whole header.
 */
#include <stdlib.h>
#include <string.h>

#include "daemon/frame.h"
#include "daemon/record/recording.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/good-frame.h"

#define MOST_PLANES_BYTES ((uint64_t)1 << 20)

static void check_planes(const struct pursuit_frame_header *header, uint64_t bytes)
{
	for (uint32_t i = 0; i < header->plane_count; i++) {
		const struct pursuit_plane *plane = &header->planes[i];
		FUZZ_EXPECT(plane->offset <= bytes && plane->size <= bytes - plane->offset);
		FUZZ_EXPECT(plane->offset % PURSUIT_PLANE_ALIGNMENT == 0);
		FUZZ_EXPECT((uint64_t)plane->width * pursuit_format_bytes(plane->format) <= plane->stride);
	}
}

/* What was validated validates again, unchanged. */
static void check_stable(const struct pursuit_frame_header *header, uint64_t bytes)
{
	struct pursuit_frame_header again = *header;
	struct error error;
	FUZZ_EXPECT(frame_validate(&again, bytes, NULL, NULL, &error) == 0);
	FUZZ_EXPECT(memcmp(&again, header, sizeof(again)) == 0);
}

/* Packs it out of memory that ends where the limit says, and validates the packed frame. */
static void check_packing(const struct pursuit_frame_header *header, uint64_t bytes)
{
	struct frame frame = {.header = *header};
	struct pursuit_frame_header packed_header;
	struct error error;
	const uint64_t packed_bytes = recording_packed_bytes(&frame);
	if (bytes > MOST_PLANES_BYTES || packed_bytes > 16 * MOST_PLANES_BYTES)
		return;
	uint8_t *planes = calloc(1, bytes ? bytes : 1), *packed = malloc(packed_bytes);
	FUZZ_EXPECT(planes && packed);
	for (uint32_t i = 0; i < header->plane_count; i++)
		frame.planes[i] = planes + header->planes[i].offset;
	recording_pack(&frame, packed);
	fuzz_touch(packed, packed_bytes);
	memcpy(&packed_header, packed, sizeof(packed_header));
	FUZZ_EXPECT(frame_validate(&packed_header, packed_bytes - sizeof(packed_header), NULL, NULL, &error) == 0);
	free(planes);
	free(packed);
}

int fuzz_one(const uint8_t *data, size_t size)
{
	struct fuzz_input input = {data, size};
	struct pursuit_frame_header header;
	struct error error = {""};
	const char *field = NULL;
	uint64_t value = 0;

	const bool whole = fuzz_u8(&input) & 1;
	const uint64_t bytes = fuzz_number(&input);
	good_frame(&header);
	if (whole) {
		size_t taken;
		const uint8_t *from = fuzz_bytes(&input, sizeof(header), &taken);
		memcpy(&header, from, taken);
	} else {
		good_frame_patch(&header, &input, 32);
	}
	if (frame_validate(&header, bytes, &field, &value, &error) < 0) {
		FUZZ_EXPECT(field && *field && error.text[0]);
		return 0;
	}
	check_planes(&header, bytes);
	check_stable(&header, bytes);
	check_packing(&header, bytes);
	return 0;
}
