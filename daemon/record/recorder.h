/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Records while the daemon runs: the thread that has the frame copies it into
 * a bounded queue and goes on; a thread of low priority compresses and writes.
 * A slow disk costs frames of the recording, which are counted, and nothing else.
 */
#ifndef PURSUIT_RECORDER_H
#define PURSUIT_RECORDER_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/error.h"
#include "daemon/frame.h"
#include "daemon/record/recording.h"

struct recorder;

struct recorder_params {
	struct recording_writer_params writer; /* level 0: 1, and faster ones while the queue fills up */
	uint64_t queue_bytes;                  /* of copied frames that wait, 0: 512 MiB */
};

struct recorder_stats {
	uint64_t frames_written;
	uint64_t frames_dropped; /* the queue was full, or writing has failed */
	uint64_t bytes_written;
	uint64_t queued_frames;
	uint64_t queued_bytes;
	bool failed;    /* nothing more is written; what was written before is readable */
	char text[512]; /* why, "" while all is well; set once */
};

/* Opens the file and starts the thread. NULL with a sentence. */
struct recorder *recorder_create(const struct recorder_params *params, struct error *error);

/*
 * Copies header and planes. Never waits for the disk: false, and counted, if
 * the queue is full, memory is short, the frame is larger than a recording holds
 * (recording_packed_bytes()) or writing has failed. One thread pushes.
 * A frame larger than the whole queue is still taken when the queue is empty.
 */
bool recorder_push(struct recorder *recorder, const struct frame *frame, uint64_t time_ns);

/* Queues the settings from here on, key=value lines. The same rules. */
bool recorder_settings(struct recorder *recorder, const char *text, uint64_t time_ns);

/* Any thread. */
void recorder_stats(struct recorder *recorder, struct recorder_stats *stats);

/*
 * Writes what is queued (this waits), closes the file, clears *recorder. NULL
 * accepted. `last` (may be NULL) gets the final figures. 0 or the negative
 * errno of the first failure with its sentence.
 */
int recorder_destroy(struct recorder **recorder, struct recorder_stats *last, struct error *error);

#endif
