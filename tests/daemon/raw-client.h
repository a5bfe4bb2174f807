/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A client that speaks the wire by hand and may say anything; and a stream of
 * shared memory that may hold anything.
 */
#ifndef PURSUIT_TEST_RAW_CLIENT_H
#define PURSUIT_TEST_RAW_CLIENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/shm.h"
#include "proto/wire.h"

#define RAW_FDS 8

struct raw_reply {
	size_t bytes;
	int fds[RAW_FDS];
	int fd_count;
	union {
		struct pursuit_message header;
		struct pursuit_message_welcome welcome;
		struct pursuit_message_refused refused;
		struct pursuit_message_stream_opened opened;
		struct pursuit_message_close_stream closed;
		struct pursuit_message_control control;
		uint8_t raw[PURSUIT_WIRE_MAX_PACKET + 1];
	};
};

int raw_connect(const char *path);
/* 0 or -errno; fds may be NULL. */
int raw_send(int socket, const void *bytes, size_t size, const int *fds, int fd_count);
/* Waits PATIENCE_MS (fixture.h) for the next packet: true; false: hung up, or nothing came. */
bool raw_receive(int socket, struct raw_reply *reply);
/* Nothing more comes: the other side has hung up. Waits PATIENCE_MS. */
bool raw_is_gone(int socket);

struct pursuit_message_hello raw_hello(void);
struct pursuit_message_open_stream raw_open(uint64_t stream_id, uint32_t slots, uint64_t slot_bytes);
/* Connects and greets; -1 if that fails. */
int raw_greet(const char *path);
/* Sends text, gives the status and puts the text of the answer into the reply, zero-terminated after the header. */
int raw_control(int socket, const char *text, int fd, struct raw_reply *reply);

#define RAW_ALL_SEALS (F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW)
/* A memfd of this size with these seals. */
int raw_memfd(uint64_t bytes, int seals);

/* The client's side of a stream, of small frames: BGRA8, depth 32F, motion RG32F. */
#define RAW_WIDTH 64u
#define RAW_HEIGHT 48u
#define RAW_SLOTS 4u
#define RAW_SLOT_BYTES (UINT64_C(15) * 4096)

struct raw_stream {
	int socket;
	uint64_t stream_id;
	int control_fd, planes_fd, wake_fd;
	struct pursuit_shm_control *control;
	uint8_t *planes;
	uint32_t own_slot;
	uint64_t next_id;
	uint64_t feedback_read;
};

/* Memory and header of a good stream; nothing is said to the daemon yet. */
void raw_stream_init(struct raw_stream *stream, int socket, uint64_t stream_id);
/* OPEN_STREAM; true if it was opened, otherwise *reply is the answer. */
bool raw_stream_open(struct raw_stream *stream, struct raw_reply *reply);
/* Unmaps and closes all but the socket. */
void raw_stream_finish(struct raw_stream *stream);

/* A good frame in the slot that the client owns: its header, to be spoilt before raw_publish(). */
struct pursuit_frame_header *raw_fill(struct raw_stream *stream);
float *raw_depth(struct raw_stream *stream);
float *raw_motion(struct raw_stream *stream);
void raw_publish(struct raw_stream *stream);
/* The next report; waits PATIENCE_MS. False: none came. */
bool raw_feedback(struct raw_stream *stream, struct pursuit_feedback *report);

#endif
