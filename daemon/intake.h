/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * One stream of a client: its two memfds mapped, its frames taken in, feedback
 * written. Believes nothing that the client wrote (proto/shm.h).
 *
 * The client cannot take the mappings away: a stream is accepted only if both
 * memfds are sealed against shrinking (so no page inside lies beyond the end)
 * and are ordinary shared memory (a huge page that cannot be had would be a
 * fault). What is left: a page that was never written, or that the client has
 * punched out, is made when it is touched, and where the kernel may not
 * overcommit (vm.overcommit_memory=2) it may have none to give. That is SIGBUS,
 * and so is a page whose hardware has failed. Nothing catches it: the daemon ends
 * (docs/faults.md).
 *
 * Threads: created on main, then stream_take(), stream_feedback() and
 * stream_hint() belong to one render thread at a time; whoever drops the last
 * reference unmaps.
 */
#ifndef PURSUIT_INTAKE_H
#define PURSUIT_INTAKE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "daemon/executable.h"
#include "daemon/frame.h"
#include "daemon/log.h"
#include "daemon/refusal.h"
#include "proto/shm.h"

/* What main may read while the render thread counts. */
struct stream_counters {
	_Atomic uint64_t real_frames; /* taken and valid */
	_Atomic uint64_t refused_frames;
	_Atomic uint64_t lost_frames; /* ids that were never seen, and frames replaced by a newer one */
	_Atomic uint64_t last_frame_id;
	_Atomic uint32_t width, height;
	_Atomic uint64_t interval_ns; /* between frames' times, 0 unknown */
};

struct stream {
	atomic_uint references;
	uint64_t client_id; /* the server's number of the connection */
	uint64_t stream_id; /* the client's, who may use one again */
	uint64_t number;    /* ours, never 0, never used again: what frames say that they are of */
	char client_name[64];
	char application[EXECUTABLE_NAME_BYTES]; /* name of the client's executable, as the kernel says; "": not known */
	int wake_fd;                             /* eventfd; the client writes, nobody reads */
	_Atomic uint64_t wake_ns;                /* when main saw the last wake-up */
	atomic_bool ended;                       /* nothing is taken any more */
	struct stream_complaint {
		bool due;  /* main is to be told, and its client */
		bool ends; /* the stream is to be ended for it */
		struct refusal refusal;
	} complaint; /* the newest; the output's */
	struct stream_counters counters;

	struct pursuit_shm_control *control;
	const uint8_t *planes;
	uint64_t planes_bytes; /* mapped */
	uint64_t slot_bytes;
	uint32_t slot_count;
	uint32_t held_slot;
	struct frame held; /* the frame in that slot, as it was taken; no planes: none, or it was refused */
	uint64_t feedback_count, hint_count;
	uint64_t last_id, last_time_ns;
	struct log_limit log_limit; /* render thread */
};

struct stream_params {
	uint64_t client_id;
	uint64_t stream_id;
	uint32_t opened; /* streams that this client has opened before, whether or not they are open */
	const char *client_name;
	const char *application; /* NULL: not known */
	uint32_t slot_count;
	uint64_t slot_bytes;
	uint64_t max_slot_bytes;
};

/*
 * Checks parameters and memfds, maps both, makes the eventfd; the memfds stay
 * the caller's. One reference. NULL with a refusal.
 */
struct stream *stream_create(const struct stream_params *params, int control_fd, int planes_fd,
							 struct refusal *refusal);
struct stream *stream_reference(struct stream *stream);
/* Clears *stream; NULL accepted. */
void stream_release(struct stream **stream);

/* Is there a frame that was not taken yet? */
bool stream_has_frame(const struct stream *stream);

/*
 * Takes the newest frame, if there is one: 1 with a validated frame whose
 * planes stay valid until the next call; 0 none; -EINVAL it was refused (told
 * to the client by feedback; the next may be fine); -EPROTO the stream broke
 * the rules of the exchange and is to be ended. now_ns: the time of this call.
 */
int stream_take(struct stream *stream, uint64_t now_ns, struct frame *frame, struct refusal *refusal);

/*
 * The frame that was taken last, once more: its slot is lent until the next is taken. For a stream that is shown again
 * and has stopped. False: there is none.
 */
bool stream_get_held(const struct stream *stream, struct frame *frame);

/* Writes one report into the feedback ring; `sequence` and `reserved` are filled in. */
void stream_feedback(struct stream *stream, const struct pursuit_feedback *report);

/* Tells the client when the frame after `frame_id` is wanted, 0 unknown, and T. */
void stream_hint(struct stream *stream, uint64_t frame_id, uint64_t next_submit_ns, uint64_t interval_ns);

#endif
