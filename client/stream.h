/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The stream's face towards the GL helper: what pursuit_submit() does, in two
 * halves, since a read-back gets its number and times when it starts and is
 * published later.
 */
#ifndef PURSUIT_CLIENT_STREAM_H
#define PURSUIT_CLIENT_STREAM_H

#include <stdbool.h>
#include <stdint.h>

#include "client/layout.h"
#include "client/pursuit.h"

/* What a frame was given when the caller handed it over. */
struct shim_ticket {
	uint64_t frame_id;
	uint64_t time_ns;
	uint64_t real_interval_ns;
};

const struct shim_layout *shim_stream_layout(const struct pursuit_stream *stream);
bool shim_stream_is_attached(const struct pursuit_stream *stream);

/* Counts the frame as submitted and numbers it. */
struct shim_ticket shim_stream_ticket(struct pursuit_stream *stream, const struct pursuit_frame *frame);

/* Gives an acquired frame away, published if the daemon is there. False if `frame` is none that is acquired. */
bool shim_stream_publish(struct pursuit_stream *stream, struct pursuit_frame *frame, const struct shim_ticket *ticket);

/* Adds to the counter of copied bytes. */
void shim_stream_count_copied(struct pursuit_stream *stream, uint64_t bytes);

/* Puts a sentence for a person into the status. */
__attribute__((format(printf, 2, 3))) void shim_stream_say(struct pursuit_stream *stream, const char *format, ...);

#endif
