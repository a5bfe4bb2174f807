/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The layout of a recording: a log of timed events in chunks.
 *
 *   file   = file header, chunk, chunk, ...
 *   chunk  = chunk header (64 bytes), payload (stored_bytes bytes), zero bytes
 *            up to the next multiple of 8
 *
 * A chunk is believed only if the checksum of its header and the checksum of
 * its payload are right, so a recording that was cut off or whose writer died
 * is readable up to its last whole chunk, and a damaged chunk is named and
 * skipped: the reader looks for the next chunk header on an 8-byte boundary.
 *
 * Payload of a FRAME chunk, before compression:
 *
 *   struct pursuit_frame_header, then the planes in the order of the header,
 *   each at its `offset` (counted from the start of the planes, which follow
 *   the header directly) with its `stride`, in wire format, bit-exact.
 *
 * INFO, SETTINGS and END hold UTF-8 text, one `key=value` a line. Chunks of
 * an unknown type are skipped, so that later versions can add events.
 *
 * Checksums are XXH3 64 bit (seed 0), compression is zstd.
 */
#ifndef PURSUIT_PROTO_RECORDING_H
#define PURSUIT_PROTO_RECORDING_H

#include <stdint.h>

#include "frame.h"

#define PURSUIT_RECORDING_MAGIC UINT64_C(0x0a1a0d0a54495550)       /* "PUIT\n\r\x1a\n" */
#define PURSUIT_RECORDING_CHUNK_MAGIC UINT64_C(0x4b4e484354495550) /* "PUITCHNK" */
#define PURSUIT_RECORDING_VERSION 1u

#define PURSUIT_CHUNK_INFO 1u     /* first chunk: stream, program, rate, comment */
#define PURSUIT_CHUNK_FRAME 2u    /* a frame of the client */
#define PURSUIT_CHUNK_SETTINGS 3u /* the settings of the daemon from here on */
#define PURSUIT_CHUNK_END 4u      /* last chunk of a recording that was closed well */

#define PURSUIT_COMPRESSION_NONE 0u
#define PURSUIT_COMPRESSION_ZSTD 1u

/* 32 bytes. */
struct pursuit_recording_header {
	uint64_t magic;
	uint32_t version;
	uint32_t header_bytes;    /* 32; a reader skips what is beyond the part that it knows */
	uint64_t created_unix_ns; /* CLOCK_REALTIME, 0 unknown */
	uint64_t reserved;
};

/* 64 bytes. */
struct pursuit_chunk_header {
	uint64_t magic;
	uint32_t type;
	uint32_t compression;
	uint64_t stored_bytes;     /* of the payload in the file, padding not counted */
	uint64_t raw_bytes;        /* of the payload after decompression */
	uint64_t sequence;         /* 0, 1, 2, ... in the file */
	uint64_t time_ns;          /* when the event reached the recorder, CLOCK_MONOTONIC; 0 unknown */
	uint64_t payload_checksum; /* of the stored bytes */
	uint64_t header_checksum;  /* of the 56 bytes before this field */
};

#endif
