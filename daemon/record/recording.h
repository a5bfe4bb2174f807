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
#include <stdint.h>

#include "daemon/error.h"
#include "daemon/frame.h"
#include "proto/recording.h"

/* ---- writing; one thread ---- */

struct recording_writer;

struct recording_writer_params {
	const char *path; /* created or replaced; ignored if fd >= 0 */
	int fd;           /* an open file (taken over), or -1 */
	int level;        /* zstd level, 0: 3; negative levels are faster */
	const char *info; /* text of the INFO chunk, key=value lines; may be NULL */
};

/* Creates the file and writes header and INFO. NULL with a sentence (disk full, permission, ...). */
struct recording_writer *recording_writer_create(const struct recording_writer_params *params, struct error *error);

/*
 * Appends one frame (planes bit-exact, laid out anew without gaps beyond the
 * row alignment). 0 or a negative errno with a sentence; after -ENOSPC the file
 * is cut back to the last whole chunk and stays readable, and later calls fail alike.
 */
int recording_writer_frame(struct recording_writer *writer, const struct frame *frame, uint64_t time_ns,
                           struct error *error);
int recording_writer_settings(struct recording_writer *writer, const char *text, uint64_t time_ns, struct error *error);

/* Writes END, syncs and closes; clears *writer. NULL accepted. 0 or a negative errno with a sentence. */
int recording_writer_close(struct recording_writer **writer, struct error *error);

/* Bytes in the file so far, frames written. */
void recording_writer_counts(const struct recording_writer *writer, uint64_t *bytes, uint64_t *frames);

/* ---- reading; one thread ---- */

struct recording_reader;

struct recording_reader_params {
	const char *path;
	uint64_t memory_limit; /* bytes for one decoded frame; 0: PURSUIT_MAX_FRAME_BYTES */
};

/* What a scan of the whole file found. */
struct recording_summary {
	uint64_t frames;
	uint64_t damaged_chunks; /* skipped: a checksum or a header was wrong */
	uint64_t first_damage_offset; /* in the file; only if damaged_chunks > 0 */
	bool closed;    /* END was found: the recording is complete */
	bool truncated; /* the last chunk was cut off */
	char damage[256]; /* a sentence about the first damage, "" if none */
};

/* Opens and scans headers (cheap: payloads are checked when read). NULL with a sentence. */
struct recording_reader *recording_reader_create(const struct recording_reader_params *params, struct error *error);
void recording_reader_destroy(struct recording_reader **reader);

const struct recording_summary *recording_reader_summary(const struct recording_reader *reader);
/* The INFO text, "" if none. Owned by the reader. */
const char *recording_reader_info(const struct recording_reader *reader);
uint64_t recording_reader_frame_count(const struct recording_reader *reader);

/*
 * Decodes frame `index` (0 up). The frame and its planes belong to the reader
 * and are valid until the next call with the same `slot` (0 to 3: so that a
 * caller can hold several frames at once). 0; -EBADMSG with a sentence if the
 * chunk is damaged (go on with the next); -ENOMEM, -EIO. time_ns may be NULL.
 */
int recording_reader_frame(struct recording_reader *reader, uint64_t index, unsigned slot, struct frame *frame,
                           uint64_t *time_ns, struct error *error);

#endif
