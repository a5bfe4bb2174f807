/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Reading and writing recordings (layout: proto/recording.h). Nothing that a
 * file says is believed before it is checked; memory is bounded by a limit of
 * the caller's, not by what the file says.
 */
#ifndef PURSUIT_RECORDING_H
#define PURSUIT_RECORDING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daemon/error.h"
#include "daemon/frame.h"
#include "proto/recording.h"

/* ---- writing; one thread ---- */

struct recording_writer;

struct recording_writer_params {
	const char *path; /* created or replaced; with a fd only its name in messages, may be NULL */
	int fd;           /* > 0: an open file, taken over even if create fails; otherwise path counts */
	int level;        /* zstd level, 0: 3; negative levels are faster */
	const char *info; /* text of the INFO chunk, key=value lines; may be NULL */
};

/*
 * Creates the file and writes header and INFO; what a file holds already, from where it stands on, is cut off.
 * The file is locked (flock) until it is closed: one that another writer is at is left as it is. A file size limit
 * (RLIMIT_FSIZE) is met like a full disk if the program ignores or blocks SIGXFSZ. NULL with a sentence (disk full,
 * permission, another writer, a file that is open for appending and would be cut, ...).
 */
struct recording_writer *recording_writer_create(const struct recording_writer_params *params, struct error *error);

/*
 * Appends one frame (planes bit-exact, laid out anew without gaps beyond the
 * row alignment). 0 or a negative errno with a sentence; after -ENOSPC the file
 * is cut back to the last whole chunk and stays readable, and later calls fail alike.
 */
int recording_writer_frame(struct recording_writer *writer, const struct frame *frame, uint64_t time_ns,
						   struct error *error);

/*
 * The same in two steps, so that one thread can copy a frame and another write
 * it: recording_pack() fills recording_packed_bytes() bytes (header, then the
 * planes laid out anew; any alignment). Frames are validated before. 0 bytes: its
 * rows, at multiples of 64 bytes, take more than PURSUIT_MAX_FRAME_BYTES, which
 * no reader takes; it cannot be packed, and recording_writer_frame() gives -EFBIG.
 */
uint64_t recording_packed_bytes(const struct frame *frame);
void recording_pack(const struct frame *frame, uint8_t *packed);
int recording_writer_packed(struct recording_writer *writer, const uint8_t *packed, uint64_t bytes, uint64_t time_ns,
							struct error *error);

/* zstd level of the frames from now on, as in the params. */
void recording_writer_set_level(struct recording_writer *writer, int level);

int recording_writer_settings(struct recording_writer *writer, const char *text, uint64_t time_ns, struct error *error);

/*
 * Writes END (unless a write failed before), syncs and closes; clears *writer.
 * NULL accepted. 0 or a negative errno with a sentence.
 */
int recording_writer_close(struct recording_writer **writer, struct error *error);

/* Bytes in the file so far, frames written. */
void recording_writer_counts(const struct recording_writer *writer, uint64_t *bytes, uint64_t *frames);

/* ---- reading; one thread ---- */

struct recording_reader;

struct recording_reader_params {
	const char *path;
	uint64_t memory_limit; /* bytes for the planes of one decoded frame; 0: PURSUIT_MAX_FRAME_BYTES */
};

/*
 * What a scan of the whole file found. A payload is checked only when it is
 * read; damage that recording_reader_frame() meets is counted here then, once.
 */
struct recording_summary {
	uint64_t frames;
	uint64_t damaged_chunks;      /* skipped: a checksum or a header was wrong */
	uint64_t first_damage_offset; /* in the file; only if damaged_chunks > 0 */
	bool closed;                  /* END was found: the recording is complete */
	bool truncated;               /* the last chunk was cut off */
	char damage[256];             /* a sentence about the first damage or the cut, "" if none */
};

/* Opens and scans headers (cheap: payloads are checked when read). NULL with a sentence. */
struct recording_reader *recording_reader_create(const struct recording_reader_params *params, struct error *error);
void recording_reader_destroy(struct recording_reader **reader);

const struct recording_summary *recording_reader_summary(const struct recording_reader *reader);
/* The INFO text, "" if none. Owned by the reader. */
const char *recording_reader_info(const struct recording_reader *reader);
/* The value of `key` in INFO text, without its line end; false if there is none or it does not fit. */
bool recording_info_value(const char *info, const char *key, char *value, size_t size);
uint64_t recording_reader_frame_count(const struct recording_reader *reader);
/* As it was opened by; lives as long as the reader. */
const char *recording_reader_path(const struct recording_reader *reader);

/*
 * Decodes frame `index` (0 up). The frame and its planes belong to the reader
 * and are valid until the next call with the same `slot` (0 to 3: so that a
 * caller can hold several frames at once). Planes lie at multiples of 64 bytes.
 * 0; -EBADMSG with a sentence if the chunk is damaged (go on with the next);
 * -ENOMEM if it is beyond the memory limit; -EIO; -EINVAL for an index or a
 * slot that there is not. time_ns, of the chunk, may be NULL.
 */
int recording_reader_frame(struct recording_reader *reader, uint64_t index, unsigned slot, struct frame *frame,
						   uint64_t *time_ns, struct error *error);

#endif
