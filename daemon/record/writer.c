/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>
#include <zstd.h>

#include "daemon/record/recording.h"

#define DEFAULT_LEVEL 3
/* One write call never asks for more, so that a signal or a slow disk is seen in between. */
#define WRITE_AT_ONCE ((size_t)64 << 20)

struct recording_writer {
	int fd;
	char *path;
	int failed;     /* the negative errno of the first failed write, then nothing more is written */
	off_t start;    /* where in the file the recording begins */
	uint64_t bytes; /* of whole chunks */
	uint64_t frames, sequence;
	ZSTD_CCtx *zstd;
	uint8_t *raw, *stored;
	size_t raw_size, stored_size;
};

static const char *errno_advice(int code)
{
	switch (code) {
	case -ENOSPC:
	case -EDQUOT:
		return ": make room or record to another disk";
	case -EFBIG:
		return ": raise the file size limit (ulimit -f)";
	case -EACCES:
	case -EPERM:
	case -EROFS:
		return ": choose a folder that you may write to";
	case -ENOENT:
		return ": make the folder first";
	default:
		return "";
	}
}

static int write_error(const struct recording_writer *writer, int code, struct error *error)
{
	return error_set(error, code, "%s: cannot be written at byte %" PRIu64 ": %s%s", writer->path, writer->bytes,
					 strerror(-code), errno_advice(code));
}

/* Grows without keeping what was there. */
static bool reserve(uint8_t **buffer, size_t *size, uint64_t bytes)
{
	if (bytes <= *size)
		return true;
	free(*buffer);
	*size = 0;
	*buffer = malloc(bytes);
	if (*buffer)
		*size = bytes;
	return *buffer != NULL;
}

static int write_all(int fd, const void *data, size_t bytes)
{
	const uint8_t *at = data;
	while (bytes > 0) {
		const ssize_t done = write(fd, at, bytes < WRITE_AT_ONCE ? bytes : WRITE_AT_ONCE);
		if (done < 0 && errno == EINTR)
			continue;
		if (done < 0)
			return -errno;
		if (done == 0)
			return -EIO;
		at += done;
		bytes -= (size_t)done;
	}
	return 0;
}

/* Nothing follows a failed write: the file ends with its last whole chunk. */
static int fail(struct recording_writer *writer, int code, struct error *error)
{
	writer->failed = code;
	const off_t end = writer->start + (off_t)writer->bytes;
	if (ftruncate(writer->fd, end) == 0)
		lseek(writer->fd, end, SEEK_SET);
	return write_error(writer, code, error);
}

static int write_chunk(struct recording_writer *writer, struct pursuit_chunk_header *chunk, const void *stored,
					   struct error *error)
{
	static const uint8_t zeros[8];
	const size_t padding = (size_t)(-chunk->stored_bytes & 7);

	if (writer->failed)
		return write_error(writer, writer->failed, error);
	chunk->magic = PURSUIT_RECORDING_CHUNK_MAGIC;
	chunk->sequence = writer->sequence;
	chunk->payload_checksum = XXH3_64bits(stored, chunk->stored_bytes);
	chunk->header_checksum = XXH3_64bits(chunk, offsetof(struct pursuit_chunk_header, header_checksum));
	int result = write_all(writer->fd, chunk, sizeof(*chunk));
	if (result == 0)
		result = write_all(writer->fd, stored, chunk->stored_bytes);
	if (result == 0)
		result = write_all(writer->fd, zeros, padding);
	if (result < 0)
		return fail(writer, result, error);
	writer->sequence++;
	writer->bytes += sizeof(*chunk) + chunk->stored_bytes + padding;
	return 0;
}

static int write_text(struct recording_writer *writer, uint32_t type, const char *text, uint64_t time_ns,
					  struct error *error)
{
	struct pursuit_chunk_header chunk = {
		.type = type,
		.compression = PURSUIT_COMPRESSION_NONE,
		.stored_bytes = strlen(text),
		.raw_bytes = strlen(text),
		.time_ns = time_ns,
	};
	return write_chunk(writer, &chunk, text, error);
}

static int write_file_header(struct recording_writer *writer, struct error *error)
{
	struct timespec now;
	struct pursuit_recording_header header = {
		.magic = PURSUIT_RECORDING_MAGIC,
		.version = PURSUIT_RECORDING_VERSION,
		.header_bytes = sizeof(header),
	};
	if (clock_gettime(CLOCK_REALTIME, &now) == 0)
		header.created_unix_ns = (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
	const int result = write_all(writer->fd, &header, sizeof(header));
	if (result < 0)
		return fail(writer, result, error);
	writer->bytes = sizeof(header);
	return 0;
}

static void writer_free(struct recording_writer *writer)
{
	if (writer->fd >= 0)
		close(writer->fd);
	ZSTD_freeCCtx(writer->zstd);
	free(writer->raw);
	free(writer->stored);
	free(writer->path);
	free(writer);
}

/* What another writer is at stays whole. Pipes and devices can be neither locked nor cut. */
static int take_file(struct recording_writer *writer, struct error *error)
{
	const off_t start = lseek(writer->fd, 0, SEEK_CUR);
	struct stat status;
	writer->start = start > 0 ? start : 0;
	if (flock(writer->fd, LOCK_EX | LOCK_NB) < 0 && errno == EWOULDBLOCK)
		return error_set(error, -EBUSY, "%s: another program is recording into it", writer->path);
	const int flags = fcntl(writer->fd, F_GETFL);
	if (flags >= 0 && (flags & O_APPEND) && fstat(writer->fd, &status) == 0 && status.st_size > writer->start)
		return error_set(error, -EEXIST,
						 "%s: is open for appending and holds %lld bytes, which a recording would cut off; open it "
						 "without O_APPEND, or an empty file",
						 writer->path, (long long)status.st_size);
	if (ftruncate(writer->fd, writer->start) < 0 && errno != EINVAL)
		return write_error(writer, -errno, error);
	return 0;
}

static int writer_open(struct recording_writer *writer, const struct recording_writer_params *params,
					   struct error *error)
{
	writer->fd = params->fd > 0 ? params->fd : -1;
	writer->path = strdup(params->path ? params->path : "recording");
	writer->zstd = ZSTD_createCCtx();
	if (!writer->path || !writer->zstd)
		return error_set(error, -ENOMEM, "recording: out of memory");
	if (writer->fd < 0 && !params->path)
		return error_set(error, -EINVAL, "recording: path is not set, must name a file");
	if (writer->fd < 0)
		writer->fd = open(params->path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
	if (writer->fd < 0)
		return error_set(error, -errno, "%s: cannot be created: %s%s", writer->path, strerror(errno),
						 errno_advice(-errno));
	return take_file(writer, error);
}

struct recording_writer *recording_writer_create(const struct recording_writer_params *params, struct error *error)
{
	struct recording_writer *writer = calloc(1, sizeof(*writer));
	if (!writer) {
		if (params->fd > 0)
			close(params->fd);
		error_set(error, -ENOMEM, "recording: out of memory");
		return NULL;
	}
	int result = writer_open(writer, params, error);
	if (result == 0) {
		recording_writer_set_level(writer, params->level);
		result = write_file_header(writer, error);
	}
	if (result == 0)
		result = write_text(writer, PURSUIT_CHUNK_INFO, params->info ? params->info : "", 0, error);
	if (result < 0) {
		writer_free(writer);
		return NULL;
	}
	return writer;
}

void recording_writer_set_level(struct recording_writer *writer, int level)
{
	ZSTD_CCtx_setParameter(writer->zstd, ZSTD_c_compressionLevel, level ? level : DEFAULT_LEVEL);
}

int recording_writer_packed(struct recording_writer *writer, const uint8_t *packed, uint64_t bytes, uint64_t time_ns,
							struct error *error)
{
	struct pursuit_chunk_header chunk = {.type = PURSUIT_CHUNK_FRAME, .raw_bytes = bytes, .time_ns = time_ns};
	const uint8_t *stored = packed;

	if (writer->failed)
		return write_error(writer, writer->failed, error);
	if (!reserve(&writer->stored, &writer->stored_size, ZSTD_compressBound(bytes)))
		return error_set(error, -ENOMEM, "%s: out of memory for a frame of %" PRIu64 " bytes", writer->path, bytes);
	const size_t result = ZSTD_compress2(writer->zstd, writer->stored, writer->stored_size, packed, bytes);
	if (!ZSTD_isError(result) && result < bytes) {
		stored = writer->stored;
		chunk.compression = PURSUIT_COMPRESSION_ZSTD;
		chunk.stored_bytes = result;
	} else {
		chunk.compression = PURSUIT_COMPRESSION_NONE;
		chunk.stored_bytes = bytes;
	}
	const int written = write_chunk(writer, &chunk, stored, error);
	if (written == 0)
		writer->frames++;
	return written;
}

int recording_writer_frame(struct recording_writer *writer, const struct frame *frame, uint64_t time_ns,
						   struct error *error)
{
	const uint64_t bytes = recording_packed_bytes(frame);
	if (bytes == 0)
		return error_set(
			error, -EFBIG,
			"%s: a frame's planes in rows at multiples of %u bytes take more than a recording holds, at most "
			"%" PRIu64,
			writer->path, PURSUIT_PLANE_ALIGNMENT, PURSUIT_MAX_FRAME_BYTES);
	if (!reserve(&writer->raw, &writer->raw_size, bytes))
		return error_set(error, -ENOMEM, "%s: out of memory for a frame of %" PRIu64 " bytes", writer->path, bytes);
	recording_pack(frame, writer->raw);
	return recording_writer_packed(writer, writer->raw, bytes, time_ns, error);
}

int recording_writer_settings(struct recording_writer *writer, const char *text, uint64_t time_ns, struct error *error)
{
	return write_text(writer, PURSUIT_CHUNK_SETTINGS, text, time_ns, error);
}

static int sync_and_close(struct recording_writer *writer, struct error *error)
{
	int result = 0;
	/* EINVAL: a pipe or a device, which has nothing to sync. */
	if (fsync(writer->fd) < 0 && errno != EINVAL && errno != EROFS)
		result = write_error(writer, -errno, error);
	const int closed = close(writer->fd);
	writer->fd = -1;
	if (closed < 0 && errno != EINTR && result == 0)
		result = write_error(writer, -errno, error);
	return result;
}

int recording_writer_close(struct recording_writer **writer, struct error *error)
{
	struct recording_writer *w = *writer;
	struct error later;
	char text[64];
	if (!w)
		return 0;
	*writer = NULL;
	snprintf(text, sizeof(text), "frames=%" PRIu64 "\n", w->frames);
	int result = write_text(w, PURSUIT_CHUNK_END, text, 0, error);
	const int closed = sync_and_close(w, result < 0 ? &later : error);
	writer_free(w);
	return result < 0 ? result : closed;
}

void recording_writer_counts(const struct recording_writer *writer, uint64_t *bytes, uint64_t *frames)
{
	*bytes = writer->bytes;
	*frames = writer->frames;
}
