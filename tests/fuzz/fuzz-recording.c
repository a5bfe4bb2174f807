/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A recording from anywhere. Input: a byte of choices, then the file. Since a
 * checksum stops a fuzzer at the door, one of the choices is to make them right
 * where the sizes allow it.
 */
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "daemon/record/recording.h"
#include "tests/fuzz/fuzz.h"

#define MEMORY_LIMIT ((uint64_t)1 << 20)
#define MOST_FRAMES 64u

enum choices {
	SEAL_HEADERS = 1,
	SEAL_PAYLOADS = 2,
};

static void seal(uint8_t *file, size_t size, uint8_t choices)
{
	struct pursuit_chunk_header chunk;
	for (size_t at = 0; at + sizeof(chunk) <= size; at += 8) {
		memcpy(&chunk, file + at, sizeof(chunk));
		if (chunk.magic != PURSUIT_RECORDING_CHUNK_MAGIC)
			continue;
		if (choices & SEAL_PAYLOADS && chunk.stored_bytes <= size - at - sizeof(chunk))
			chunk.payload_checksum = XXH3_64bits(file + at + sizeof(chunk), chunk.stored_bytes);
		if (choices & SEAL_HEADERS)
			chunk.header_checksum = XXH3_64bits(&chunk, offsetof(struct pursuit_chunk_header, header_checksum));
		memcpy(file + at, &chunk, sizeof(chunk));
	}
}

static void read_frames(struct recording_reader *reader)
{
	const uint64_t count = recording_reader_frame_count(reader);
	struct error error = {""};
	struct frame frame;
	uint64_t time_ns;
	for (uint64_t i = 0; i < count && i < MOST_FRAMES; i++) {
		const int result = recording_reader_frame(reader, i, (unsigned)i % 4, &frame, &time_ns, &error);
		if (result < 0) {
			FUZZ_EXPECT(error.text[0]);
			continue;
		}
		for (uint32_t k = 0; k < frame.header.plane_count; k++)
			fuzz_touch(frame.planes[k], frame.header.planes[k].size);
	}
	FUZZ_EXPECT(recording_reader_frame(reader, count, 0, &frame, NULL, &error) < 0);
	FUZZ_EXPECT(recording_reader_frame(reader, 0, 4, &frame, NULL, &error) < 0);
}

int fuzz_one(const uint8_t *data, size_t size)
{
	struct fuzz_input input = {data, size};
	struct fuzz_file file;
	struct error error = {""};
	char value[16];
	const int open_fds = fuzz_open_fds();
	const uint8_t choices = fuzz_u8(&input);
	uint8_t *copy = malloc(input.size + 1);

	FUZZ_EXPECT(copy != NULL);
	memcpy(copy, input.data, input.size);
	seal(copy, input.size, choices);
	fuzz_file_init(&file, copy, input.size);
	const struct recording_reader_params params = {.path = file.path, .memory_limit = MEMORY_LIMIT};
	struct recording_reader *reader = recording_reader_create(&params, &error);
	if (reader) {
		const struct recording_summary *summary = recording_reader_summary(reader);
		FUZZ_EXPECT(summary->frames == recording_reader_frame_count(reader));
		FUZZ_EXPECT(summary->frames * sizeof(struct pursuit_chunk_header) <= input.size);
		recording_info_value(recording_reader_info(reader), "program", value, sizeof(value));
		read_frames(reader);
	} else {
		FUZZ_EXPECT(error.text[0]);
	}
	recording_reader_destroy(&reader);
	fuzz_file_finish(&file);
	free(copy);
	FUZZ_EXPECT(fuzz_open_fds() == open_fds);
	return 0;
}
