/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>
#include <xxhash.h>

#include "daemon/record/recording.h"
#include "tests/record/sample.h"
#include "tests/test.h"

#define FRAMES 4u
#define CHUNK ((uint64_t)sizeof(struct pursuit_chunk_header))

static struct sample samples[FRAMES];

static struct recording_reader *open_reader(const char *path, uint64_t memory_limit, struct error *error)
{
	const struct recording_reader_params params = {.path = path, .memory_limit = memory_limit};
	return recording_reader_create(&params, error);
}

/* INFO, the samples, SETTINGS before the last, END. */
static void write_samples(const char *path, int level)
{
	const struct recording_writer_params params = {.path = path, .level = level, .info = "stream=test\nfps=30\n"};
	struct error error = {""};
	struct recording_writer *writer = recording_writer_create(&params, &error);
	CHECK(writer != NULL);
	for (unsigned i = 0; i < FRAMES; i++) {
		if (i == FRAMES - 1)
			CHECK_INT(recording_writer_settings(writer, "method=grid\n", 7, &error), 0);
		CHECK_INT(recording_writer_frame(writer, &samples[i].frame, 100 + i, &error), 0);
	}
	uint64_t bytes, frames;
	recording_writer_counts(writer, &bytes, &frames);
	CHECK_INT(frames, FRAMES);
	CHECK(bytes > 0 && bytes % 8 == 0);
	CHECK_INT(recording_writer_close(&writer, &error), 0);
	CHECK(writer == NULL);
	CHECK_INT(recording_writer_close(&writer, &error), 0);
}

/* Plays all frames that decode; counts them, and fails if one that decodes is not one of the samples. */
static unsigned play(struct recording_reader *reader, bool strict)
{
	unsigned good = 0;
	for (uint64_t i = 0; i < recording_reader_frame_count(reader); i++) {
		struct frame frame;
		struct error error = {""};
		const int result = recording_reader_frame(reader, i, (unsigned)(i % 4), &frame, NULL, &error);
		if (result < 0) {
			CHECK(error.text[0] != '\0');
			continue;
		}
		const uint64_t id = frame.header.frame_id;
		const bool known = id >= 1 && id <= FRAMES && sample_equal(&frame, &samples[id - 1].frame);
		if (strict)
			CHECK(known);
		good++;
	}
	return good;
}

static void test_round_trip(void)
{
	static const int levels[] = {0, -3, 1, 9};
	for (size_t l = 0; l < sizeof(levels) / sizeof(levels[0]); l++) {
		struct error error = {""};
		write_samples(sample_path("a.pursuit"), levels[l]);
		struct recording_reader *reader = open_reader(sample_path("a.pursuit"), 0, &error);
		CHECK(reader != NULL);
		const struct recording_summary *summary = recording_reader_summary(reader);
		CHECK_INT(summary->frames, FRAMES);
		CHECK_INT(summary->damaged_chunks, 0);
		CHECK(summary->closed && !summary->truncated);
		CHECK_STRING(summary->damage, "");
		CHECK_STRING(recording_reader_info(reader), "stream=test\nfps=30\n");
		CHECK_INT(play(reader, true), FRAMES);
		struct frame frames[2];
		uint64_t time_ns = 0;
		CHECK_INT(recording_reader_frame(reader, 2, 0, &frames[0], &time_ns, &error), 0);
		CHECK_INT(recording_reader_frame(reader, 1, 3, &frames[1], NULL, &error), 0);
		CHECK_INT(time_ns, 102);
		CHECK(sample_equal(&frames[0], &samples[2].frame) && sample_equal(&frames[1], &samples[1].frame));
		for (unsigned i = 0; i < frames[0].header.plane_count; i++)
			CHECK_INT((uintptr_t)frames[0].planes[i] % 64, 0);
		CHECK_INT(recording_reader_frame(reader, FRAMES, 0, &frames[0], NULL, &error), -EINVAL);
		CHECK_INT(recording_reader_frame(reader, 0, 4, &frames[0], NULL, &error), -EINVAL);
		recording_reader_destroy(&reader);
		CHECK(reader == NULL);
		recording_reader_destroy(&reader);
	}
}

static void test_unknown_role_is_carried(void)
{
	struct error error = {""};
	const struct recording_writer_params params = {.path = sample_path("role.pursuit")};
	struct recording_writer *writer = recording_writer_create(&params, &error);
	uint8_t blob[100];
	struct frame frame = samples[0].frame, got;
	memset(blob, 0xa5, sizeof(blob));
	frame.header.plane_count = 6;
	frame.header.planes[5] = (struct pursuit_plane){.role = 77,
													.format = 999,
													.storage = PURSUIT_STORAGE_MEMORY,
													.width = 10,
													.height = 3,
													.stride = 20,
													.size = 100};
	frame.planes[5] = blob;
	CHECK_INT(recording_writer_frame(writer, &frame, 1, &error), 0);
	CHECK_INT(recording_writer_close(&writer, &error), 0);
	struct recording_reader *reader = open_reader(sample_path("role.pursuit"), 0, &error);
	CHECK_INT(recording_reader_frame(reader, 0, 0, &got, NULL, &error), 0);
	CHECK_INT(got.header.planes[5].role, 77);
	CHECK_INT(got.header.planes[5].format, 999);
	CHECK_INT(got.header.planes[5].size, 100);
	CHECK(memcmp(got.planes[5], blob, sizeof(blob)) == 0);
	recording_reader_destroy(&reader);
}

static void test_info_values(void)
{
	char value[8];
	const char *info = "fps=30\r\nnumber_offset=-1\nname=\nlong=123456789\n";
	CHECK(recording_info_value(info, "fps", value, sizeof(value)));
	CHECK_STRING(value, "30");
	CHECK(recording_info_value(info, "number_offset", value, sizeof(value)));
	CHECK_STRING(value, "-1");
	CHECK(recording_info_value(info, "name", value, sizeof(value)));
	CHECK_STRING(value, "");
	CHECK(!recording_info_value(info, "long", value, sizeof(value)));
	CHECK(!recording_info_value(info, "offset", value, sizeof(value)));
	CHECK(!recording_info_value("", "fps", value, sizeof(value)));
}

/* ---- damage ---- */

/* Offset of each chunk of a whole file. */
static unsigned chunk_offsets(const uint8_t *data, size_t size, uint64_t *offsets, unsigned room)
{
	unsigned count = 0;
	for (uint64_t at = sizeof(struct pursuit_recording_header); at + CHUNK <= size && count < room;) {
		struct pursuit_chunk_header chunk;
		memcpy(&chunk, data + at, sizeof(chunk));
		offsets[count++] = at;
		at = (at + CHUNK + chunk.stored_bytes + 7) / 8 * 8;
	}
	return count;
}

static uint32_t chunk_type(const uint8_t *data, uint64_t offset)
{
	struct pursuit_chunk_header chunk;
	memcpy(&chunk, data + offset, sizeof(chunk));
	return chunk.type;
}

/* Cut at every byte: what is whole before the cut plays, and the cut is told. */
static void test_cut_anywhere(void)
{
	size_t size;
	uint64_t offsets[16];
	write_samples(sample_path("b.pursuit"), 0);
	uint8_t *data = sample_read_file(sample_path("b.pursuit"), &size);
	const unsigned chunks = chunk_offsets(data, size, offsets, 16);
	CHECK_INT(chunks, FRAMES + 3);
	sample_write_file(sample_path("cut.pursuit"), data, size);
	const char *cut = sample_path("cut.pursuit");
	for (size_t length = size; length-- > 0;) {
		struct error error = {""};
		unsigned whole = 0;
		bool at_boundary = length >= size - 7;
		for (unsigned c = 0; c < chunks; c++) {
			struct pursuit_chunk_header chunk;
			memcpy(&chunk, data + offsets[c], sizeof(chunk));
			const uint64_t end = offsets[c] + CHUNK + chunk.stored_bytes;
			whole += length >= end && chunk.type == PURSUIT_CHUNK_FRAME;
			at_boundary |= (length >= end && length <= (end + 7) / 8 * 8) || length == offsets[c];
		}
		CHECK_INT(truncate(cut, (off_t)length), 0);
		struct recording_reader *reader = open_reader(cut, 0, &error);
		if (length < sizeof(struct pursuit_recording_header)) {
			CHECK(reader == NULL && strstr(error.text, "shorter than its header"));
			continue;
		}
		CHECK(reader != NULL);
		CHECK_INT(recording_reader_frame_count(reader), whole);
		CHECK_INT(play(reader, true), whole);
		CHECK_INT(recording_reader_summary(reader)->truncated, !at_boundary);
		CHECK_INT(recording_reader_summary(reader)->damaged_chunks, 0);
		CHECK_INT(recording_reader_summary(reader)->damage[0] != '\0', !at_boundary);
		if (length < offsets[chunks - 1] + CHUNK)
			CHECK(!recording_reader_summary(reader)->closed);
		recording_reader_destroy(&reader);
	}
	free(data);
}

/* Each bit flipped: at most the chunk that holds it is lost, and it is named. */
static void test_any_bit_flipped(void)
{
	size_t size;
	uint64_t offsets[16];
	write_samples(sample_path("c.pursuit"), 0);
	uint8_t *data = sample_read_file(sample_path("c.pursuit"), &size);
	const unsigned chunks = chunk_offsets(data, size, offsets, 16);
	const int fd = open(sample_path("c.pursuit"), O_RDWR | O_CLOEXEC);
	const char *path = sample_path("c.pursuit");
	for (size_t byte = 0; byte < size; byte++) {
		unsigned chunk = 0;
		while (chunk + 1 < chunks && offsets[chunk + 1] <= byte)
			chunk++;
		for (unsigned bit = 0; bit < 8; bit++) {
			struct error error = {""};
			const uint8_t flipped = (uint8_t)(data[byte] ^ (1u << bit));
			CHECK_INT(pwrite(fd, &flipped, 1, (off_t)byte), 1);
			struct recording_reader *reader = open_reader(path, 0, &error);
			if (byte >= 8 && byte < 12) {
				CHECK(reader == NULL && strstr(error.text, "version is"));
				continue;
			}
			CHECK(reader != NULL);
			if (!reader)
				continue;
			struct pursuit_chunk_header header;
			memcpy(&header, data + offsets[chunk], sizeof(header));
			const bool in_header = byte < sizeof(struct pursuit_recording_header);
			const uint64_t end = offsets[chunk] + CHUNK + header.stored_bytes;
			const bool frame_hit = !in_header && header.type == PURSUIT_CHUNK_FRAME && byte < end;
			const bool seen = in_header ? byte < 16 || byte >= 24
										: byte < offsets[chunk] + CHUNK ||
											  (byte < end && (frame_hit || header.type == PURSUIT_CHUNK_INFO));
			CHECK_INT(play(reader, true), FRAMES - (frame_hit ? 1 : 0));
			const struct recording_summary *summary = recording_reader_summary(reader);
			CHECK_INT(summary->damaged_chunks, seen ? 1 : 0);
			CHECK_INT(summary->damage[0] != '\0', seen);
			if (seen && !in_header)
				CHECK_INT(summary->first_damage_offset, offsets[chunk]);
			if (frame_hit) {
				char name[32];
				snprintf(name, sizeof(name), "chunk %u at byte", chunk);
				CHECK(strstr(summary->damage, name) != NULL);
			}
			recording_reader_destroy(&reader);
		}
		CHECK_INT(pwrite(fd, &data[byte], 1, (off_t)byte), 1);
	}
	close(fd);
	free(data);
}

static void seal_chunk(uint8_t *data, uint64_t offset, struct pursuit_chunk_header chunk)
{
	chunk.header_checksum = XXH3_64bits(&chunk, 56);
	memcpy(data + offset, &chunk, sizeof(chunk));
}

/* Headers that lie with a right checksum: the frame is refused by its field, memory is not taken. */
static void test_sizes_that_lie(void)
{
	static const struct {
		uint64_t stored, raw;
		uint32_t compression;
		int result;
		const char *sentence;
	} lies[] = {
		{0, UINT64_MAX, 1, -ENOMEM, "raw_bytes is 18446744073709551615"},
		{0, (uint64_t)1 << 40, 1, -ENOMEM, "memory limit"},
		{0, 1023, 1, -EBADMSG, "raw_bytes is 1023"},
		{0, 0, 1, -EBADMSG, "raw_bytes is 0"},
		{0, 1024, 1, -EBADMSG, "zstd: "},
		{0, 0x10000, 1, -EBADMSG, "raw_bytes"},
		{0, 0x10000, 0, -EBADMSG, "stored_bytes"},
		{0, 0x10000, 9, -EBADMSG, "compression is 9"},
		{8, 0x10000, 1, -EBADMSG, "payload_checksum"},
	};
	size_t size;
	uint64_t offsets[16];
	write_samples(sample_path("d.pursuit"), 0);
	uint8_t *data = sample_read_file(sample_path("d.pursuit"), &size);
	chunk_offsets(data, size, offsets, 16);
	struct pursuit_chunk_header whole;
	memcpy(&whole, data + offsets[2], sizeof(whole));
	for (size_t i = 0; i < sizeof(lies) / sizeof(lies[0]); i++) {
		struct error error = {""};
		struct pursuit_chunk_header chunk = whole;
		struct frame frame;
		chunk.stored_bytes = lies[i].stored ? lies[i].stored : whole.stored_bytes;
		chunk.raw_bytes = lies[i].raw;
		chunk.compression = lies[i].compression;
		if (lies[i].raw == 0x10000 && lies[i].compression == 1 && lies[i].stored == 0)
			chunk.raw_bytes = whole.raw_bytes + 64; /* zstd yields less than was said */
		seal_chunk(data, offsets[2], chunk);
		sample_write_file(sample_path("lie.pursuit"), data, size);
		struct recording_reader *reader = open_reader(sample_path("lie.pursuit"), 0, &error);
		CHECK(reader != NULL);
		CHECK_INT(recording_reader_frame(reader, 1, 0, &frame, NULL, &error), lies[i].result);
		if (!strstr(error.text, lies[i].sentence))
			CHECK_STRING(error.text, lies[i].sentence);
		CHECK_INT(recording_reader_frame(reader, 0, 0, &frame, NULL, &error), 0);
		CHECK_INT(play(reader, true), FRAMES - 1);
		recording_reader_destroy(&reader);
	}
	/* A chunk that says it goes on behind the end of the file: everything from there is cut off. */
	whole.stored_bytes = UINT64_MAX - 20;
	seal_chunk(data, offsets[2], whole);
	sample_write_file(sample_path("lie.pursuit"), data, size);
	struct error error = {""};
	struct recording_reader *reader = open_reader(sample_path("lie.pursuit"), 0, &error);
	CHECK(reader != NULL && recording_reader_summary(reader)->truncated);
	CHECK_INT(play(reader, true), 1);
	recording_reader_destroy(&reader);
	free(data);
}

/* Every field of a frame header in a recording is checked like one from a client. */
static void test_frame_header_is_untrusted(void)
{
	struct error error = {""};
	struct frame bad = samples[0].frame, got;
	const struct recording_writer_params params = {.path = sample_path("e.pursuit")};
	struct recording_writer *writer = recording_writer_create(&params, &error);
	uint8_t *packed = malloc(recording_packed_bytes(&bad));
	const uint64_t bytes = recording_packed_bytes(&bad);
	recording_pack(&bad, packed);
	struct pursuit_frame_header *header = (struct pursuit_frame_header *)(void *)packed;
	header->planes[1].offset = 64 * (UINT64_MAX / 64);
	CHECK_INT(recording_writer_packed(writer, packed, bytes, 1, &error), 0);
	header->planes[1].offset = bytes / 64 * 64;
	CHECK_INT(recording_writer_packed(writer, packed, bytes, 2, &error), 0);
	CHECK_INT(recording_writer_frame(writer, &bad, 3, &error), 0);
	CHECK_INT(recording_writer_close(&writer, &error), 0);
	free(packed);
	struct recording_reader *reader = open_reader(sample_path("e.pursuit"), 0, &error);
	for (uint64_t i = 0; i < 2; i++) {
		CHECK_INT(recording_reader_frame(reader, i, 0, &got, NULL, &error), -EBADMSG);
		CHECK(strstr(error.text, "frame 1: planes[1].offset is") != NULL);
		CHECK(strstr(error.text, "e.pursuit: chunk") != NULL);
	}
	/* Told once each, however often they are read. */
	CHECK_INT(recording_reader_frame(reader, 0, 0, &got, NULL, &error), -EBADMSG);
	CHECK_INT(recording_reader_summary(reader)->damaged_chunks, 2);
	CHECK_INT(recording_reader_frame(reader, 2, 0, &got, NULL, &error), 0);
	recording_reader_destroy(&reader);
}

static void test_memory_limit(void)
{
	struct error error = {""};
	struct frame frame;
	write_samples(sample_path("f.pursuit"), 0);
	struct frame copy = samples[0].frame;
	const uint64_t planes = recording_packed_bytes(&copy) - sizeof(struct pursuit_frame_header);
	struct recording_reader *reader = open_reader(sample_path("f.pursuit"), planes - 1, &error);
	CHECK_INT(recording_reader_frame(reader, 0, 0, &frame, NULL, &error), -ENOMEM);
	CHECK(strstr(error.text, "raw_bytes is") && strstr(error.text, "memory limit"));
	CHECK_INT(recording_reader_summary(reader)->damaged_chunks, 0);
	recording_reader_destroy(&reader);
	reader = open_reader(sample_path("f.pursuit"), planes, &error);
	CHECK_INT(recording_reader_frame(reader, 0, 0, &frame, NULL, &error), 0);
	recording_reader_destroy(&reader);
}

/* Chunks cut out and chunks put in: the rest plays. */
static void test_missing_and_foreign_chunks(void)
{
	size_t size;
	uint64_t offsets[16];
	struct error error = {""};
	write_samples(sample_path("g.pursuit"), 0);
	uint8_t *data = sample_read_file(sample_path("g.pursuit"), &size);
	chunk_offsets(data, size, offsets, 16);
	uint8_t *edited = malloc(2 * size);
	memcpy(edited, data, offsets[2]);
	memcpy(edited + offsets[2], data + offsets[4], size - offsets[4]);
	sample_write_file(sample_path("gap.pursuit"), edited, size - offsets[4] + offsets[2]);
	struct recording_reader *reader = open_reader(sample_path("gap.pursuit"), 0, &error);
	CHECK_INT(play(reader, true), FRAMES - 2);
	CHECK_INT(recording_reader_summary(reader)->damaged_chunks, 2);
	CHECK(strstr(recording_reader_summary(reader)->damage, "chunks 2 to 3") != NULL);
	recording_reader_destroy(&reader);

	struct pursuit_chunk_header chunk;
	memcpy(&chunk, data + offsets[1], sizeof(chunk));
	CHECK_INT(chunk_type(data, offsets[1]), PURSUIT_CHUNK_FRAME);
	chunk.type = 4711;
	seal_chunk(data, offsets[1], chunk);
	sample_write_file(sample_path("type.pursuit"), data, size);
	reader = open_reader(sample_path("type.pursuit"), 0, &error);
	CHECK_INT(play(reader, true), FRAMES - 1);
	CHECK_INT(recording_reader_summary(reader)->damaged_chunks, 0);
	recording_reader_destroy(&reader);

	/* Rubbish between two chunks, down to the smallest that keeps the boundary. */
	for (size_t rubbish = 8; rubbish <= 640; rubbish *= 2) {
		memcpy(edited, data, offsets[3]);
		memset(edited + offsets[3], 0x55, rubbish);
		memcpy(edited + offsets[3] + rubbish, data + offsets[3], size - offsets[3]);
		sample_write_file(sample_path("rubbish.pursuit"), edited, size + rubbish);
		reader = open_reader(sample_path("rubbish.pursuit"), 0, &error);
		CHECK_INT(play(reader, true), FRAMES - 1);
		CHECK_INT(recording_reader_summary(reader)->damaged_chunks, 1);
		CHECK_INT(recording_reader_summary(reader)->first_damage_offset, offsets[3]);
		CHECK(recording_reader_summary(reader)->closed);
		recording_reader_destroy(&reader);
	}
	free(edited);
	free(data);
}

static void test_not_a_recording(void)
{
	struct error error = {""};
	CHECK(!open_reader(sample_path("missing.pursuit"), 0, &error));
	CHECK(strstr(error.text, "missing.pursuit: cannot be opened") != NULL);
	CHECK(!open_reader(sample_folder(), 0, &error));
	CHECK(strstr(error.text, "must be a regular file") != NULL);
	sample_write_file(sample_path("empty.pursuit"), "", 0);
	CHECK(!open_reader(sample_path("empty.pursuit"), 0, &error));
	sample_write_file(sample_path("text.pursuit"), "this is no recording but it is long enough for one header", 57);
	CHECK(!open_reader(sample_path("text.pursuit"), 0, &error));
	CHECK(strstr(error.text, "magic is 0x") != NULL);
}

/* ---- a full disk ---- */

static void test_full_disk(void)
{
	struct error error = {""};
	if (access("/dev/full", W_OK) != 0)
		return;
	const struct recording_writer_params params = {.path = "/dev/full"};
	CHECK(!recording_writer_create(&params, &error));
	CHECK(strstr(error.text, "/dev/full") && strstr(error.text, "make room"));
}

/* A file size limit in the middle of the third frame: two frames stay readable, and nothing half is left. */
static void test_disk_fills_up(void)
{
	struct error error = {""};
	size_t size;
	uint64_t offsets[16], bytes, frames;
	struct rlimit before;
	write_samples(sample_path("h.pursuit"), 0);
	uint8_t *data = sample_read_file(sample_path("h.pursuit"), &size);
	chunk_offsets(data, size, offsets, 16);
	CHECK_INT(getrlimit(RLIMIT_FSIZE, &before), 0);
	signal(SIGXFSZ, SIG_IGN);
	for (unsigned where = 0; where < 3; where++) {
		const uint64_t within[] = {8, CHUNK, CHUNK + 100};
		const struct rlimit limit = {offsets[3] + within[where], before.rlim_max};
		const struct recording_writer_params params = {.path = sample_path("full.pursuit"),
													   .info = "stream=test\nfps=30\n"};
		CHECK_INT(setrlimit(RLIMIT_FSIZE, &limit), 0);
		struct recording_writer *writer = recording_writer_create(&params, &error);
		CHECK_INT(recording_writer_frame(writer, &samples[0].frame, 1, &error), 0);
		CHECK_INT(recording_writer_frame(writer, &samples[1].frame, 2, &error), 0);
		CHECK_INT(recording_writer_frame(writer, &samples[2].frame, 3, &error), -EFBIG);
		CHECK(strstr(error.text, "full.pursuit") && strstr(error.text, "limit"));
		CHECK_INT(recording_writer_frame(writer, &samples[3].frame, 4, &error), -EFBIG);
		recording_writer_counts(writer, &bytes, &frames);
		CHECK_INT(frames, 2);
		CHECK_INT(bytes, offsets[3]);
		CHECK_INT(recording_writer_close(&writer, &error), -EFBIG);
		CHECK_INT(setrlimit(RLIMIT_FSIZE, &before), 0);
		size_t left;
		free(sample_read_file(sample_path("full.pursuit"), &left));
		CHECK_INT(left, offsets[3]);
		struct recording_reader *reader = open_reader(sample_path("full.pursuit"), 0, &error);
		CHECK_INT(play(reader, true), 2);
		CHECK(!recording_reader_summary(reader)->truncated && !recording_reader_summary(reader)->closed);
		recording_reader_destroy(&reader);
	}
	free(data);
}

static void test_cannot_create(void)
{
	struct error error = {""};
	const struct recording_writer_params params = {.path = sample_path("no-such-folder/x.pursuit")};
	CHECK(!recording_writer_create(&params, &error));
	CHECK(strstr(error.text, "no-such-folder") && strstr(error.text, "make the folder first"));
}

/* What another writer is at is left as it is, and what was there before is gone when one begins. */
static void test_one_writer_a_file(void)
{
	struct error error = {""};
	const struct recording_writer_params params = {.path = sample_path("one.pursuit")};
	write_samples(params.path, 0);
	struct recording_writer *first = recording_writer_create(&params, &error);
	CHECK(first != NULL);
	CHECK_INT(recording_writer_frame(first, &samples[0].frame, 1, &error), 0);
	CHECK(!recording_writer_create(&params, &error));
	CHECK(strstr(error.text, "one.pursuit") && strstr(error.text, "another program"));
	CHECK_INT(recording_writer_frame(first, &samples[1].frame, 2, &error), 0);
	CHECK_INT(recording_writer_close(&first, &error), 0);
	struct recording_reader *reader = open_reader(params.path, 0, &error);
	CHECK(reader != NULL);
	CHECK_INT(play(reader, true), 2);
	CHECK_STRING(recording_reader_summary(reader)->damage, "");
	recording_reader_destroy(&reader);
}

/* A file that the caller has opened, longer than what is written into it. */
static void test_open_file_is_replaced(void)
{
	struct error error = {""};
	write_samples(sample_path("given.pursuit"), 0);
	const struct recording_writer_params params = {.fd = open(sample_path("given.pursuit"), O_WRONLY | O_CLOEXEC)};
	struct recording_writer *writer = recording_writer_create(&params, &error);
	CHECK_INT(recording_writer_frame(writer, &samples[2].frame, 1, &error), 0);
	CHECK_INT(recording_writer_close(&writer, &error), 0);
	struct recording_reader *reader = open_reader(sample_path("given.pursuit"), 0, &error);
	CHECK_INT(play(reader, true), 1);
	CHECK_STRING(recording_reader_summary(reader)->damage, "");
	recording_reader_destroy(&reader);
}

/* A good frame whose rows, at multiples of 64 bytes, would take more than a reader takes: refused, and the next is not.
 */
static void test_beyond_the_limit(void)
{
	struct error error = {""};
	struct frame frame = {.header = samples[0].frame.header};
	frame.header.plane_count = 2;
	for (uint32_t i = 0; i < 2; i++) {
		struct pursuit_plane *plane = &frame.header.planes[i];
		plane->width = i ? 8193 : 8191;
		plane->height = 16384;
		plane->format = i ? PURSUIT_FORMAT_DEPTH32F : PURSUIT_FORMAT_BGRA8;
		plane->stride = (uint64_t)plane->width * 4;
		plane->size = plane->stride * plane->height;
	}
	CHECK_INT(frame_validate(&frame.header, PURSUIT_MAX_FRAME_BYTES, NULL, NULL, &error), 0);
	CHECK_INT(recording_packed_bytes(&frame), 0);
	const struct recording_writer_params params = {.path = sample_path("huge.pursuit")};
	struct recording_writer *writer = recording_writer_create(&params, &error);
	CHECK_INT(recording_writer_frame(writer, &frame, 1, &error), -EFBIG);
	CHECK(strstr(error.text, "huge.pursuit") && strstr(error.text, "at most 1073741824"));
	CHECK_INT(recording_writer_frame(writer, &samples[1].frame, 2, &error), 0);
	CHECK_INT(recording_writer_close(&writer, &error), 0);
	struct recording_reader *reader = open_reader(params.path, 0, &error);
	CHECK_INT(play(reader, true), 1);
	recording_reader_destroy(&reader);
}

int main(void)
{
	for (unsigned i = 0; i < FRAMES; i++)
		sample_init(&samples[i], i + 1, 7, 5);
	RUN(test_round_trip);
	RUN(test_unknown_role_is_carried);
	RUN(test_info_values);
	RUN(test_cut_anywhere);
	RUN(test_any_bit_flipped);
	RUN(test_sizes_that_lie);
	RUN(test_frame_header_is_untrusted);
	RUN(test_memory_limit);
	RUN(test_missing_and_foreign_chunks);
	RUN(test_not_a_recording);
	RUN(test_full_disk);
	RUN(test_disk_fills_up);
	RUN(test_cannot_create);
	RUN(test_one_writer_a_file);
	RUN(test_open_file_is_replaced);
	RUN(test_beyond_the_limit);
	for (unsigned i = 0; i < FRAMES; i++)
		sample_finish(&samples[i]);
	sample_folder_remove();
	return test_result();
}
