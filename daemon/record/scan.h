/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The first look at a recording: where its chunks are and what is damaged.
 * Used by the reader only. Work is linear in the size of the file, memory in
 * the number of its frames.
 */
#ifndef PURSUIT_RECORD_SCAN_H
#define PURSUIT_RECORD_SCAN_H

#include "daemon/record/recording.h"

struct scan_entry {
	uint64_t offset; /* of the chunk header in the file */
	bool damaged;    /* its payload was found damaged and counted */
};

struct scan {
	int fd;
	char *path;
	uint64_t size; /* of the file when it was opened */
	uint64_t next_sequence;
	struct recording_summary summary;
	char *info;
	struct scan_entry *frames;
	uint64_t frame_count, frame_room;
};

/* Opens and scans. 0 or a negative errno with a sentence; scan_finish() in both cases. */
int scan_init(struct scan *scan, const char *path, struct error *error);
void scan_finish(struct scan *scan);

/* Reads exactly `bytes` at `offset`: 0, -EBADMSG if the file ends before, -EIO and the like. */
int scan_read(const struct scan *scan, void *to, uint64_t bytes, uint64_t offset);

/* Reads a chunk header and checks its magic and checksum: 0, -EBADMSG, -EIO and the like. */
int scan_chunk(const struct scan *scan, uint64_t offset, struct pursuit_chunk_header *chunk);

/* Counts a damaged chunk; the first one is told in the summary. */
void scan_note_damage(struct scan *scan, uint64_t offset, const char *sentence);

#endif
