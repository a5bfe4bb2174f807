/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * One client of the server: its connection, its streams. Private to the server.
 *
 *   new --HELLO/WELCOME--> greeted --OPEN_STREAM, CLOSE_STREAM, CONTROL--> ...
 */
#ifndef PURSUIT_CLIENT_H
#define PURSUIT_CLIENT_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "daemon/packet.h"
#include "daemon/peer.h"
#include "daemon/server.h"

struct client;

struct client_stream {
	struct client *client;
	struct stream *stream; /* NULL: free */
	struct loop_source *wake;
	bool wants_keys;
};

struct client {
	const struct server_params *params;
	struct packet *packet; /* the server's, shared by all */
	struct client *next;
	uint64_t id;
	int fd;
	struct loop_source *source;
	int process; /* that connected, as a pidfd; -1: not watched */
	struct loop_source *process_source;
	bool greeted;
	bool gone; /* to be removed by the server */
	struct peer peer;
	uint64_t connected_ns;
	char name[64];
	struct client_stream streams[PURSUIT_MAX_STREAMS_PER_CLIENT];
	uint64_t stream_bytes; /* mapped, of all streams */
	uint32_t opened;       /* streams, ever */
	struct message_rate {
		uint64_t second;
		uint32_t count;
	} rate;
	struct log_limit log_limit;
};

/* Takes the fd over. NULL: no memory. */
struct client *client_create(const struct server_params *params, struct packet *packet, int fd, const struct peer *peer,
							 uint64_t id);
/* Closes the connection and ends its streams. */
void client_destroy(struct client **client);

/* Reads what has come; may set `gone`. */
void client_read(struct client *client, uint32_t events);

/* Sends; a full socket or a broken one sets `gone`. */
void client_send(struct client *client, const void *message, size_t bytes, int fd);
void client_refuse(struct client *client, uint32_t serial, uint64_t stream_id, bool fatal,
				   const struct refusal *refusal);

struct client_stream *client_find_stream(struct client *client, uint64_t stream_id);
/* Says STREAM_CLOSED (serial 0: unasked). */
void client_close_stream(struct client_stream *entry, uint32_t serial);

#endif
