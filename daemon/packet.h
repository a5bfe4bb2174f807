/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Packets of proto/wire.h: received with their file descriptors, sent without
 * ever waiting.
 */
#ifndef PURSUIT_PACKET_H
#define PURSUIT_PACKET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/wire.h"

/* More than any message has; what is beyond is closed by the kernel and noticed. */
#define PACKET_FDS 8

/* 64 KiB and more: not for the stack. */
struct packet {
	size_t bytes;
	bool too_long; /* longer than PURSUIT_WIRE_MAX_PACKET */
	bool fds_lost;
	int fds[PACKET_FDS]; /* close-on-exec; the packet's until taken */
	uint32_t fd_count;
	union {
		struct pursuit_message header;
		struct pursuit_message_hello hello;
		struct pursuit_message_open_stream open;
		struct pursuit_message_close_stream close;
		struct pursuit_message_control control;
		uint8_t raw[PURSUIT_WIRE_MAX_PACKET + 1];
	};
};

/* 1 a packet, 0 none yet, -ECONNRESET the other side is gone, or another negative errno. */
int packet_receive(int fd, struct packet *packet);
/* Closes the fds that were not taken. */
void packet_finish(struct packet *packet);
/* Fd `index`, now the caller's. */
int packet_take_fd(struct packet *packet, uint32_t index);

/* With one fd, unless it is -1. 0, or -EAGAIN: the socket is full, or another negative errno. */
int packet_send(int socket, const void *message, size_t bytes, int fd);

/* Reads away what is there, so that closing the socket does not destroy what was sent. */
void packet_drain(int socket);

#endif
