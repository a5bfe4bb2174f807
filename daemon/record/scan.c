/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/record/scan.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>
#include <zstd.h>

#define BLOCK ((size_t)64 << 10)
#define MAX_INFO ((uint64_t)1 << 20)
#define HEADER_BYTES ((uint64_t)sizeof(struct pursuit_chunk_header))

int scan_read(const struct scan *scan, void *to, uint64_t bytes, uint64_t offset)
{
	uint8_t *at = to;
	while (bytes > 0) {
		const ssize_t got = pread(scan->fd, at, bytes < (1u << 30) ? bytes : (1u << 30), (off_t)offset);
		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0)
			return -errno;
		if (got == 0)
			return -EBADMSG;
		at += got;
		offset += (uint64_t)got;
		bytes -= (uint64_t)got;
	}
	return 0;
}

int scan_chunk(const struct scan *scan, uint64_t offset, struct pursuit_chunk_header *chunk)
{
	const int result = scan_read(scan, chunk, sizeof(*chunk), offset);
	if (result < 0)
		return result;
	if (chunk->magic != PURSUIT_RECORDING_CHUNK_MAGIC ||
		chunk->header_checksum != XXH3_64bits(chunk, offsetof(struct pursuit_chunk_header, header_checksum)))
		return -EBADMSG;
	return 0;
}

static void note_sentence(struct scan *scan, const char *sentence)
{
	if (!scan->summary.damage[0])
		snprintf(scan->summary.damage, sizeof(scan->summary.damage), "%s", sentence);
}

void scan_note_damage(struct scan *scan, uint64_t offset, const char *sentence)
{
	if (scan->summary.damaged_chunks++ == 0) {
		scan->summary.first_damage_offset = offset;
		scan->summary.damage[0] = '\0';
	}
	note_sentence(scan, sentence);
}

static void note_cut(struct scan *scan, uint64_t offset)
{
	char text[256];
	snprintf(text, sizeof(text),
			 "%.120s: chunk %" PRIu64 " at byte %" PRIu64 " is cut off: the file ends at byte %" PRIu64, scan->path,
			 scan->next_sequence, offset, scan->size);
	scan->summary.truncated = true;
	note_sentence(scan, text);
}

static int add_frame(struct scan *scan, uint64_t offset)
{
	if (scan->frame_count == scan->frame_room) {
		const uint64_t room = scan->frame_room ? scan->frame_room * 2 : 64;
		struct scan_entry *frames = realloc(scan->frames, room * sizeof(*frames));
		if (!frames)
			return -ENOMEM;
		scan->frames = frames;
		scan->frame_room = room;
	}
	scan->frames[scan->frame_count++] = (struct scan_entry){.offset = offset};
	return 0;
}

/* Text for people: what a terminal would obey becomes a question mark. */
static void tame_text(char *text)
{
	for (unsigned char *c = (unsigned char *)text; *c; c++)
		if ((*c < 0x20 && *c != '\n' && *c != '\t') || *c == 0x7f)
			*c = '?';
}

static char *load_text(const struct scan *scan, const struct pursuit_chunk_header *chunk, uint64_t offset)
{
	const uint64_t raw = chunk->raw_bytes, stored = chunk->stored_bytes;
	char *text = NULL, *data = NULL;

	if (raw > MAX_INFO || stored > ZSTD_compressBound(raw) || chunk->compression > PURSUIT_COMPRESSION_ZSTD ||
		(chunk->compression == PURSUIT_COMPRESSION_NONE && raw != stored))
		return NULL;
	text = calloc(1, raw + 1);
	data = malloc(stored + 1);
	bool good = text && data && scan_read(scan, data, stored, offset + HEADER_BYTES) == 0 &&
				XXH3_64bits(data, stored) == chunk->payload_checksum;
	if (good && chunk->compression == PURSUIT_COMPRESSION_NONE)
		memcpy(text, data, raw);
	else if (good)
		good = ZSTD_decompress(text, raw, data, stored) == raw;
	free(data);
	if (!good) {
		free(text);
		return NULL;
	}
	tame_text(text);
	return text;
}

static void take_info(struct scan *scan, const struct pursuit_chunk_header *chunk, uint64_t offset)
{
	char sentence[256];
	if (scan->info)
		return;
	scan->info = load_text(scan, chunk, offset);
	if (scan->info)
		return;
	snprintf(sentence, sizeof(sentence), "chunk %" PRIu64 " (INFO) at byte %" PRIu64 " is damaged", chunk->sequence,
			 offset);
	scan_note_damage(scan, offset, sentence);
}

/* Chunks that are not where the numbering says they should be: lost with a damaged header, or cut out. */
static void note_missing(struct scan *scan, const struct pursuit_chunk_header *chunk, uint64_t from, uint64_t to)
{
	char sentence[256];
	const uint64_t first = scan->next_sequence, last = chunk->sequence - 1;
	/* A number that no file reaches is itself the damage. */
	const bool absurd = chunk->sequence > first && chunk->sequence - first > UINT32_MAX;
	const uint64_t lost = absurd ? 1 : chunk->sequence > first ? chunk->sequence - first : 0;

	if (from == to && lost == 0)
		return;
	if (lost <= 1)
		snprintf(sentence, sizeof(sentence), "chunk %" PRIu64 " at byte %" PRIu64 " is damaged: its header is wrong",
				 first, from);
	else
		snprintf(sentence, sizeof(sentence),
				 "chunks %" PRIu64 " to %" PRIu64 " at byte %" PRIu64 " are damaged or missing", first, last, from);
	scan_note_damage(scan, from, sentence);
	scan->summary.damaged_chunks += lost > 1 ? lost - 1 : 0;
}

static int take_chunk(struct scan *scan, const struct pursuit_chunk_header *chunk, uint64_t offset)
{
	scan->next_sequence = chunk->sequence + 1;
	switch (chunk->type) {
	case PURSUIT_CHUNK_INFO:
		take_info(scan, chunk, offset);
		return 0;
	case PURSUIT_CHUNK_FRAME:
		return add_frame(scan, offset);
	case PURSUIT_CHUNK_END:
		scan->summary.closed = true;
		return 0;
	default:
		return 0;
	}
}

/* The first believable chunk header at or after `offset`, on an 8-byte boundary; the size of the file if none. */
static int find_chunk(const struct scan *scan, uint64_t offset, uint64_t *found)
{
	uint64_t block[BLOCK / sizeof(uint64_t)];
	struct pursuit_chunk_header chunk;

	for (offset = (offset + 7) & ~UINT64_C(7); offset < scan->size && scan->size - offset >= HEADER_BYTES;) {
		const uint64_t left = scan->size - offset;
		const size_t words = (left < BLOCK ? left : BLOCK) / sizeof(uint64_t);
		int result = scan_read(scan, block, words * sizeof(uint64_t), offset);
		if (result < 0)
			return result;
		for (size_t i = 0; i < words; i++) {
			*found = offset + i * sizeof(uint64_t);
			if (block[i] != PURSUIT_RECORDING_CHUNK_MAGIC)
				continue;
			result = scan_chunk(scan, *found, &chunk);
			if (result != -EBADMSG)
				return result;
		}
		offset += words * sizeof(uint64_t);
	}
	*found = scan->size;
	return 0;
}

/* One step of the scan: the chunk at or after *offset, which moves behind it. */
static int step(struct scan *scan, uint64_t *offset)
{
	struct pursuit_chunk_header chunk;
	uint64_t at = *offset;
	int result = 0;

	if (scan->size - at < HEADER_BYTES) {
		note_cut(scan, at);
		*offset = scan->size;
		return 0;
	}
	result = scan_chunk(scan, at, &chunk);
	if (result == -EBADMSG) {
		result = find_chunk(scan, at + 8, &at);
		if (result == 0 && at < scan->size)
			result = scan_chunk(scan, at, &chunk);
		else if (result == 0)
			chunk.sequence = scan->next_sequence;
	}
	if (result < 0)
		return result;
	note_missing(scan, &chunk, *offset, at);
	if (at == scan->size) {
		*offset = at;
		return 0;
	}
	if (chunk.stored_bytes > scan->size - at - HEADER_BYTES) {
		scan->next_sequence = chunk.sequence;
		note_cut(scan, at);
		*offset = scan->size;
		return 0;
	}
	*offset = at + HEADER_BYTES + chunk.stored_bytes;
	*offset = (*offset + 7) & ~UINT64_C(7);
	if (*offset > scan->size)
		*offset = scan->size;
	return take_chunk(scan, &chunk, at);
}

/* The header of the file has no checksum, so a wrong field is forgiven where a chunk follows all the same. */
static int check_file_header(struct scan *scan, uint64_t *start, struct error *error)
{
	struct pursuit_recording_header header;
	struct pursuit_chunk_header chunk;

	*start = sizeof(header);
	int result = scan_read(scan, &header, sizeof(header), 0);
	if (result < 0)
		return error_set(error, result, "%s: not a recording: %s", scan->path,
						 result == -EBADMSG ? "shorter than its header of 32 bytes" : strerror(-result));
	const bool follows = scan_chunk(scan, sizeof(header), &chunk) == 0;
	if (header.magic != PURSUIT_RECORDING_MAGIC && !follows)
		return error_set(error, -EBADMSG, "%s: not a recording: magic is 0x%016" PRIx64 ", must be 0x%016" PRIx64,
						 scan->path, header.magic, PURSUIT_RECORDING_MAGIC);
	if (header.magic != PURSUIT_RECORDING_MAGIC) {
		scan_note_damage(scan, 0, "the header of the file is damaged: magic is wrong");
		return 0;
	}
	if (header.version != PURSUIT_RECORDING_VERSION)
		return error_set(error, -EPROTONOSUPPORT,
						 "%s: version is %" PRIu32 ", must be %u: play it with the program that made it", scan->path,
						 header.version, PURSUIT_RECORDING_VERSION);
	if (header.header_bytes == sizeof(header) || follows) {
		if (header.header_bytes != sizeof(header))
			scan_note_damage(scan, 12, "the header of the file is damaged: header_bytes is wrong");
		else if (header.reserved != 0)
			scan_note_damage(scan, 24, "the header of the file is damaged: reserved is not 0");
		return 0;
	}
	if (header.header_bytes < sizeof(header) || header.header_bytes % 8 != 0 || header.header_bytes > scan->size)
		return 0;
	*start = header.header_bytes;
	return 0;
}

static int scan_open(struct scan *scan, struct error *error)
{
	struct stat stat;
	/* Not to hang on a pipe; a regular file does not care. */
	scan->fd = open(scan->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (scan->fd < 0)
		return error_set(error, -errno, "%s: cannot be opened: %s", scan->path, strerror(errno));
	if (fstat(scan->fd, &stat) < 0)
		return error_set(error, -errno, "%s: cannot be opened: %s", scan->path, strerror(errno));
	if (!S_ISREG(stat.st_mode))
		return error_set(error, -EINVAL, "%s: not a recording: must be a regular file", scan->path);
	scan->size = (uint64_t)stat.st_size;
	return 0;
}

int scan_init(struct scan *scan, const char *path, struct error *error)
{
	uint64_t offset = 0;
	*scan = (struct scan){.fd = -1, .path = strdup(path)};
	if (!scan->path)
		return error_set(error, -ENOMEM, "%s: out of memory", path);
	int result = scan_open(scan, error);
	if (result == 0)
		result = check_file_header(scan, &offset, error);
	if (result < 0)
		return result;
	while (offset < scan->size) {
		result = step(scan, &offset);
		if (result < 0)
			return error_set(error, result, "%s: byte %" PRIu64 ": cannot be read: %s", path, offset,
							 strerror(-result));
	}
	scan->summary.frames = scan->frame_count;
	return 0;
}

void scan_finish(struct scan *scan)
{
	if (scan->fd >= 0)
		close(scan->fd);
	free(scan->path);
	free(scan->info);
	free(scan->frames);
	*scan = (struct scan){.fd = -1};
}
