/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Frame slots in shared memory.
 *
 * A stream has two memfds, both made and sealed by the client:
 *
 *   control  one struct pursuit_shm_control; F_SEAL_SHRINK, F_SEAL_GROW and
 *            F_SEAL_SEAL; mapped read-write by both sides.
 *   planes   slot_count x slot_bytes bytes of pixels, slot i at i x slot_bytes;
 *            the same seals; the daemon maps it read-only.
 *
 * Publication is a wait-free exchange. At any moment each slot belongs to the
 * client, to the daemon, or is the one named by `latest`. The client fills a
 * slot of its own (planes, then header) and exchanges its index | FRESH with
 * `latest` (acquire and release); what comes back is the slot that it may
 * fill next. The daemon, seeing FRESH, exchanges the one slot that it holds
 * with `latest`; what comes back is the newest frame. So neither side ever
 * waits for the other, the newest frame wins, and no slot is shared.
 *
 *   at the start:  daemon holds slot 0, latest = 1 (not fresh),
 *                  the client owns slots 2 to slot_count - 1
 *
 * If the word that comes back to the client still has FRESH set, the frame in
 * it was replaced by the newer one before the daemon saw it.
 *
 * The daemon believes nothing here: a slot index out of range ends the
 * stream; headers are copied once and only the copy is read; planes may change
 * while they are read, so rows are copied to private memory before a value in
 * them decides anything.
 *
 * Feedback runs the other way: a ring that only the daemon writes. Entry i of
 * the ring (i = n modulo PURSUIT_FEEDBACK_ENTRIES) holds report number n. The
 * daemon stores 2n + 1 in `sequence`, the fields, then 2n + 2 (release). A
 * reader that sees 2n + 2 before and after has a whole report.
 */
#ifndef PURSUIT_PROTO_SHM_H
#define PURSUIT_PROTO_SHM_H

#include <stdint.h>

#include "frame.h"

#define PURSUIT_SHM_MAGIC UINT32_C(0x53525550) /* "PURS" */
#define PURSUIT_SHM_VERSION 1u
#define PURSUIT_MIN_SLOTS 3u
#define PURSUIT_MAX_SLOTS 8u
#define PURSUIT_FEEDBACK_ENTRIES 64u

/* Set in `latest` while the frame in that slot has not been taken. */
#define PURSUIT_SLOT_FRESH UINT32_C(0x80000000)
#define PURSUIT_SLOT_INDEX_MASK UINT32_C(0x000000ff)

/* struct pursuit_feedback.state */
#define PURSUIT_FEEDBACK_SHOWN 1u    /* all its vblanks are over; the times are known */
#define PURSUIT_FEEDBACK_REPLACED 2u /* a newer real frame came before its first vblank */
#define PURSUIT_FEEDBACK_REFUSED 3u  /* invalid; the log of the daemon says why */

/* What became of one real frame. Times: CLOCK_MONOTONIC ns, 0 unknown. 96 bytes. */
struct pursuit_feedback {
	uint64_t sequence; /* atomic, see above */
	uint64_t frame_id;
	uint64_t submit_ns;
	uint64_t intake_ns;
	uint64_t target_ns;
	uint64_t ready_ns;
	uint64_t flip_ns;
	uint64_t vblank;      /* number of the vblank of its first showing */
	uint32_t state;       /* PURSUIT_FEEDBACK_* */
	uint32_t vblanks;     /* how many vblanks it and its in-betweens filled */
	uint32_t in_betweens; /* how many of them were in-between frames */
	uint32_t late_in_betweens;
	uint64_t next_submit_ns; /* hint: publish the next frame by then; 0: none */
	uint64_t reserved;
};

/*
 * When the daemon would like the next frame, written as soon as it knows: at the drawing of each real frame. 32 bytes.
 * `sequence` rises by two with each hint and is odd while one is written; 0: there was none.
 */
struct pursuit_hint {
	uint64_t sequence; /* atomic */
	uint64_t frame_id; /* of the real frame that was drawn last */
	uint64_t
		next_submit_ns;   /* publish the frame after it by then, to be shown at the next vblank expected; 0: unknown */
	uint64_t interval_ns; /* T as the pacer knows it; 0: unknown */
};

/* The control page. 16384 bytes, mapped whole. */
struct pursuit_shm_control {
	uint32_t magic;
	uint32_t version;
	uint32_t slot_count;
	uint32_t reserved0;
	uint64_t slot_bytes;
	uint8_t reserved1[40];
	uint32_t latest; /* atomic: slot index | PURSUIT_SLOT_FRESH; a cache line of its own */
	uint32_t reserved2[15];
	uint64_t feedback_count;  /* atomic: reports written so far */
	struct pursuit_hint hint; /* written by the daemon */
	uint32_t background;      /* atomic, written by the daemon: 1 while another stream is shown instead of this one */
	uint32_t reserved3;
	uint64_t reserved5[2];
	struct pursuit_frame_header headers[PURSUIT_MAX_SLOTS];
	struct pursuit_feedback feedback[PURSUIT_FEEDBACK_ENTRIES];
	uint8_t reserved4[1856];
};

#endif
