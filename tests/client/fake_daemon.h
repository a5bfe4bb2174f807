/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The daemon's side of proto/wire.h and proto/shm.h, for tests of the client:
 * written from the contract, good or bad on request. Stepped by the test, so
 * that an order of events can be chosen, or run in a process of its own, so
 * that it can be killed.
 */
#ifndef PURSUIT_FAKE_DAEMON_H
#define PURSUIT_FAKE_DAEMON_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "proto/shm.h"
#include "proto/wire.h"

enum fake_manner {
	FAKE_GOOD,
	FAKE_SILENT,          /* accepts, reads nothing, answers nothing */
	FAKE_NOT_ACCEPTING,   /* not even that */
	FAKE_REFUSES_VERSION, /* REFUSED for HELLO, then closes with OPEN_STREAM unread */
	FAKE_REFUSES_STREAM,  /* REFUSED for OPEN_STREAM, stays connected */
	FAKE_SHORT_PACKET,
	FAKE_LONG_PACKET,
	FAKE_EMPTY_PACKET,
	FAKE_UNKNOWN_TYPE,
	FAKE_LYING_SIZE, /* header.size is not the packet's */
	FAKE_WRONG_VERSION,
	FAKE_FDS_WITH_WELCOME,
	FAKE_MANY_FDS, /* 40 with STREAM_OPENED */
	FAKE_NO_FD,
	FAKE_PIPE_FOR_WAKE,
	FAKE_SOCKET_FOR_WAKE,
	FAKE_FILE_FOR_WAKE,
	FAKE_BLOCKING_FULL_WAKE, /* an eventfd whose counter is full and that blocks */
	FAKE_OTHER_STREAM,
	FAKE_OPENED_FIRST, /* STREAM_OPENED without WELCOME */
	FAKE_TWO_WELCOMES,
	FAKE_FLOOD, /* as many REFUSED as fit, whenever it can */
	FAKE_MANNERS
};

struct fake_daemon {
	enum fake_manner manner;
	int listener;
	int client;
	int wake;
	char path[100];
	struct pursuit_shm_control *control; /* NULL: no stream */
	const uint8_t *planes;
	uint64_t planes_bytes;
	uint32_t slot_bytes;
	uint32_t slot_count;
	uint32_t held;
	uint32_t accepts;
	bool bad_offer; /* what the client sent is not what the contract says */
	char client_name[64];
};

/* Listens at `path`, in place of what was there. False with a message on stderr. */
bool fake_start(struct fake_daemon *daemon, const char *path, enum fake_manner manner);

/* Closes everything. `path` stays behind, as after a crash, unless `unlink_path`. */
void fake_stop(struct fake_daemon *daemon, bool unlink_path);

/* Does what is due on the sockets, without waiting. */
void fake_step(struct fake_daemon *daemon);

/* The newest frame that was not taken yet, or NULL. Its planes start at *planes. */
const struct pursuit_frame_header *fake_take(struct fake_daemon *daemon, const uint8_t **planes);

/* Writes the next report into the ring. */
void fake_report(struct fake_daemon *daemon, uint64_t frame_id, uint32_t state);

/* Ends the stream: STREAM_CLOSED, after a REFUSED that says `why` unless that is NULL. */
void fake_close_stream(struct fake_daemon *daemon, const char *why);

/* Says that it is stopping. */
void fake_say_shutdown(struct fake_daemon *daemon);

/* The value of the eventfd, which is reset to 0. */
uint64_t fake_wakes(struct fake_daemon *daemon);

/* A good daemon in a process of its own, taking every frame; ready when this returns. */
pid_t fake_fork(const char *path);

#endif
