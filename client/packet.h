/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * One packet of proto/wire.h in or out, with file descriptors. Never waits,
 * never raises a signal, and no descriptor that arrives is ever leaked: what
 * the caller does not take is closed by shim_packet_finish().
 */
#ifndef PURSUIT_CLIENT_PACKET_H
#define PURSUIT_CLIENT_PACKET_H

#include <stdbool.h>
#include <stddef.h>

#include "proto/wire.h"

/* More than any message carries, so that one too many is seen as such. */
#define SHIM_PACKET_FDS 4

struct shim_packet {
	union {
		struct pursuit_message header;
		struct pursuit_message_welcome welcome;
		struct pursuit_message_refused refused;
		struct pursuit_message_stream_opened opened;
		struct pursuit_message_close_stream closed;
		struct pursuit_message_key key;
	};
	size_t bytes;   /* as received */
	bool truncated; /* longer than any message that a client is sent */
	bool fds_lost;  /* descriptors did not fit: too many of them, or this process has no more */
	int fds[SHIM_PACKET_FDS];
	int fd_count;
};

/* A non-blocking, close-on-exec socket connected to `path`, or a negative errno. */
int shim_packet_connect(const char *path);

/* 0, or a negative errno; -EAGAIN: the socket is full. */
int shim_packet_send(int socket, const void *bytes, size_t size, const int *fds, int fd_count);

/* 1: *packet is filled, to be finished; 0: there is none; -EPIPE: the peer is gone; or another negative errno. */
int shim_packet_receive(int socket, struct shim_packet *packet);

/* Closes the descriptors that are still in the packet. */
void shim_packet_finish(struct shim_packet *packet);

/* Takes the only descriptor out of the packet; it is the caller's. -1 if there is not exactly one. */
int shim_packet_take_fd(struct shim_packet *packet);

#endif
