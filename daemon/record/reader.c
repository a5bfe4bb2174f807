/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>
#include <zstd.h>

#include "daemon/record/scan.h"

#define SLOTS 4u

/* The memory of one decoded frame. */
struct slot {
	uint8_t *raw;
	size_t size;
};

struct recording_reader {
	struct scan scan;
	uint64_t memory_limit;
	ZSTD_DCtx *zstd;
	uint8_t *stored;
	size_t stored_size;
	struct slot slots[SLOTS];
};

struct recording_reader *recording_reader_create(const struct recording_reader_params *params, struct error *error)
{
	struct recording_reader *reader = calloc(1, sizeof(*reader));
	if (!reader) {
		error_set(error, -ENOMEM, "%s: out of memory", params->path);
		return NULL;
	}
	reader->memory_limit = params->memory_limit ? params->memory_limit : PURSUIT_MAX_FRAME_BYTES;
	if (reader->memory_limit > PURSUIT_MAX_FRAME_BYTES)
		reader->memory_limit = PURSUIT_MAX_FRAME_BYTES;
	reader->zstd = ZSTD_createDCtx();
	if (scan_init(&reader->scan, params->path, error) < 0) {
		recording_reader_destroy(&reader);
		return NULL;
	}
	if (!reader->zstd) {
		error_set(error, -ENOMEM, "%s: out of memory", params->path);
		recording_reader_destroy(&reader);
	}
	return reader;
}

void recording_reader_destroy(struct recording_reader **reader)
{
	struct recording_reader *r = *reader;
	if (!r)
		return;
	*reader = NULL;
	scan_finish(&r->scan);
	ZSTD_freeDCtx(r->zstd);
	free(r->stored);
	for (unsigned i = 0; i < SLOTS; i++)
		free(r->slots[i].raw);
	free(r);
}

const struct recording_summary *recording_reader_summary(const struct recording_reader *reader)
{
	return &reader->scan.summary;
}

const char *recording_reader_info(const struct recording_reader *reader)
{
	return reader->scan.info ? reader->scan.info : "";
}

const char *recording_reader_path(const struct recording_reader *reader)
{
	return reader->scan.path;
}

uint64_t recording_reader_frame_count(const struct recording_reader *reader)
{
	return reader->scan.frame_count;
}

bool recording_info_value(const char *info, const char *key, char *value, size_t size)
{
	const size_t length = strlen(key);
	for (const char *line = info; line && *line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL) {
		if (strncmp(line, key, length) != 0 || line[length] != '=')
			continue;
		const char *from = line + length + 1;
		const size_t bytes = strcspn(from, "\r\n");
		if (bytes >= size)
			return false;
		memcpy(value, from, bytes);
		value[bytes] = '\0';
		return true;
	}
	return false;
}

/* ---- one frame ---- */

/* What the reading of one frame carries along. */
struct load {
	struct recording_reader *reader;
	struct pursuit_chunk_header chunk;
	uint64_t offset; /* of the chunk in the file */
	struct error *error;
};

static bool reserve(uint8_t **buffer, size_t *size, uint64_t bytes)
{
	if (bytes <= *size)
		return true;
	free(*buffer);
	bytes = (bytes + 63) / 64 * 64;
	*buffer = aligned_alloc(64, bytes);
	*size = *buffer ? bytes : 0;
	return *buffer != NULL;
}

static int damaged(const struct load *load, const char *what, uint64_t is, uint64_t must)
{
	return error_set(load->error, -EBADMSG,
					 "%s: chunk %" PRIu64 " at byte %" PRIu64 ": %s is %" PRIu64 ", must be %" PRIu64,
					 load->reader->scan.path, load->chunk.sequence, load->offset, what, is, must);
}

static int check_sizes(const struct load *load)
{
	const struct pursuit_chunk_header *chunk = &load->chunk;
	const uint64_t header_bytes = sizeof(struct pursuit_frame_header);

	if (chunk->compression > PURSUIT_COMPRESSION_ZSTD)
		return damaged(load, "compression", chunk->compression, PURSUIT_COMPRESSION_ZSTD);
	if (chunk->raw_bytes < header_bytes)
		return damaged(load, "raw_bytes", chunk->raw_bytes, header_bytes);
	if (chunk->raw_bytes - header_bytes > load->reader->memory_limit)
		return error_set(load->error, -ENOMEM,
						 "%s: chunk %" PRIu64 " at byte %" PRIu64 ": raw_bytes is %" PRIu64 ", must be at most %" PRIu64
						 " (memory limit)",
						 load->reader->scan.path, chunk->sequence, load->offset, chunk->raw_bytes,
						 load->reader->memory_limit + header_bytes);
	if (chunk->compression == PURSUIT_COMPRESSION_NONE && chunk->stored_bytes != chunk->raw_bytes)
		return damaged(load, "stored_bytes", chunk->stored_bytes, chunk->raw_bytes);
	if (chunk->stored_bytes > ZSTD_compressBound(chunk->raw_bytes))
		return damaged(load, "stored_bytes", chunk->stored_bytes, ZSTD_compressBound(chunk->raw_bytes));
	return 0;
}

static int read_stored(const struct load *load, uint8_t *to)
{
	const struct pursuit_chunk_header *chunk = &load->chunk;
	const int result = scan_read(&load->reader->scan, to, chunk->stored_bytes, load->offset + sizeof(*chunk));
	if (result < 0)
		return error_set(load->error, result, "%s: chunk %" PRIu64 " at byte %" PRIu64 ": cannot be read: %s",
						 load->reader->scan.path, chunk->sequence, load->offset, strerror(-result));
	const uint64_t checksum = XXH3_64bits(to, chunk->stored_bytes);
	if (checksum != chunk->payload_checksum)
		return damaged(load, "payload_checksum", checksum, chunk->payload_checksum);
	return 0;
}

/* Payload into the slot, decompressed; memory is taken only after the sizes were checked. */
static int load_payload(const struct load *load, struct slot *slot)
{
	struct recording_reader *reader = load->reader;
	const struct pursuit_chunk_header *chunk = &load->chunk;
	const bool compressed = chunk->compression == PURSUIT_COMPRESSION_ZSTD;
	int result = check_sizes(load);
	if (result < 0)
		return result;
	if (!reserve(&slot->raw, &slot->size, chunk->raw_bytes) ||
		(compressed && !reserve(&reader->stored, &reader->stored_size, chunk->stored_bytes)))
		return error_set(load->error, -ENOMEM, "%s: chunk %" PRIu64 ": out of memory for raw_bytes %" PRIu64,
						 reader->scan.path, chunk->sequence, chunk->raw_bytes);
	if (!compressed)
		return read_stored(load, slot->raw);
	result = read_stored(load, reader->stored);
	if (result < 0)
		return result;
	const size_t raw =
		ZSTD_decompressDCtx(reader->zstd, slot->raw, chunk->raw_bytes, reader->stored, chunk->stored_bytes);
	if (ZSTD_isError(raw))
		return error_set(load->error, -EBADMSG, "%s: chunk %" PRIu64 " at byte %" PRIu64 ": zstd: %s",
						 reader->scan.path, chunk->sequence, load->offset, ZSTD_getErrorName(raw));
	return raw == chunk->raw_bytes ? 0 : damaged(load, "raw_bytes", raw, chunk->raw_bytes);
}

static int load_frame(const struct load *load, struct slot *slot, struct frame *frame)
{
	struct error why;
	const uint64_t header_bytes = sizeof(frame->header);
	int result = load_payload(load, slot);
	if (result < 0)
		return result;
	*frame = (struct frame){0};
	memcpy(&frame->header, slot->raw, header_bytes);
	result = frame_validate(&frame->header, load->chunk.raw_bytes - header_bytes, NULL, NULL, &why);
	if (result < 0)
		return error_set(load->error, -EBADMSG, "%s: chunk %" PRIu64 " at byte %" PRIu64 ": %s",
						 load->reader->scan.path, load->chunk.sequence, load->offset, why.text);
	for (uint32_t i = 0; i < frame->header.plane_count; i++)
		frame->planes[i] = slot->raw + header_bytes + frame->header.planes[i].offset;
	return 0;
}

int recording_reader_frame(struct recording_reader *reader, uint64_t index, unsigned slot, struct frame *frame,
						   uint64_t *time_ns, struct error *error)
{
	struct load load = {.reader = reader, .error = error};
	if (index >= reader->scan.frame_count)
		return error_set(error, -EINVAL, "%s: frame index is %" PRIu64 ", must be below %" PRIu64, reader->scan.path,
						 index, reader->scan.frame_count);
	if (slot >= SLOTS)
		return error_set(error, -EINVAL, "slot is %u, must be 0 to 3", slot);
	struct scan_entry *entry = &reader->scan.frames[index];
	load.offset = entry->offset;
	/* The file may have changed since the scan, so its header is not believed from memory. */
	int result = scan_chunk(&reader->scan, load.offset, &load.chunk);
	if (result == -EBADMSG)
		result = error_set(error, -EBADMSG, "%s: chunk at byte %" PRIu64 ": header has changed since it was scanned",
						   reader->scan.path, load.offset);
	else if (result < 0)
		result = error_set(error, result, "%s: byte %" PRIu64 ": cannot be read: %s", reader->scan.path, load.offset,
						   strerror(-result));
	else
		result = load_frame(&load, &reader->slots[slot], frame);
	if (result == -EBADMSG && !entry->damaged) {
		entry->damaged = true;
		scan_note_damage(&reader->scan, load.offset, error->text);
	}
	if (result == 0 && time_ns)
		*time_ns = load.chunk.time_ns;
	return result;
}
