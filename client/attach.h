/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The way to the daemon: a socket and the conversation of proto/wire.h, done
 * in steps that never wait. The time is passed in (CLOCK_MONOTONIC ns).
 *
 *              connect, HELLO, OPEN_STREAM             STREAM_OPENED
 *   DETACHED ------------------------------> ATTACHING -------------> ATTACHED
 *       ^ ^                                   |   |                      |
 *       | +--- gone, silent for 5 s, nonsense +   | REFUSED              |
 *       |                                         v                      |
 *       +---------- 2 s later ------------- REFUSED                      |
 *       +------------------ hang-up, STREAM_CLOSED ----------------------+
 *
 * OPEN_STREAM follows HELLO without waiting for WELCOME: this client speaks one
 * version, so the answer could not change what it sends, and one frame of a
 * slow game is saved. A missing daemon is looked for every 5, 10, 20 and then
 * 25 ms, so that a game of 30 frames a second is back within two frames; a try
 * costs a few microseconds.
 */
#ifndef PURSUIT_CLIENT_ATTACH_H
#define PURSUIT_CLIENT_ATTACH_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "client/layout.h"
#include "client/packet.h"
#include "client/slots.h"

#define SHIM_PATH_BYTES 256
#define SHIM_MESSAGE_BYTES 192
#define SHIM_KEYS 32u

struct shim_attach {
	enum pursuit_state state;
	int socket;                 /* -1: none */
	pid_t process;              /* that connected: a child of fork() has a copy of the socket, and no part in it */
	int wake;                   /* the daemon's eventfd, only when attached; -1: none */
	bool greeted;               /* WELCOME has come */
	bool complained;            /* a REFUSED has come that did not end the connection */
	struct shim_slots *offered; /* sent with OPEN_STREAM, not yet accepted */
	uint64_t next_try_ns;
	uint64_t give_up_ns; /* while attaching */
	uint64_t delay_ns;   /* before the next try of a missing daemon */
	double refresh_hz;   /* 0: unknown */
	bool wants_keys;
	struct pursuit_key keys[SHIM_KEYS]; /* a ring; the oldest are lost */
	uint64_t keys_put, keys_taken;      /* ever */
	uint32_t path_count;
	char paths[2][SHIM_PATH_BYTES]; /* tried in this order */
	char name[64];
	char message[SHIM_MESSAGE_BYTES]; /* why the state is what it is */
};

/* Neither string is kept. False if socket_path is given and too long for an address. */
bool shim_attach_init(struct shim_attach *attach, const char *socket_path, const char *name);
void shim_attach_finish(struct shim_attach *attach);

enum shim_attach_change {
	SHIM_ATTACH_SAME,
	SHIM_ATTACH_GAINED, /* `offered` was accepted: the caller takes it out */
	SHIM_ATTACH_LOST    /* the slots that were accepted are nobody's now */
};

/* Does what is due. Returns at once. */
enum shim_attach_change shim_attach_step(struct shim_attach *attach, const struct shim_layout *layout, uint64_t now_ns);

/* The oldest key press not yet taken. */
bool shim_attach_next_key(struct shim_attach *attach, struct pursuit_key *key);

/* Wakes the daemon after a publication; only when attached. Never waits. */
void shim_attach_wake(struct shim_attach *attach);

/* Ends an attachment whose daemon broke the rules of shared memory. */
void shim_attach_break(struct shim_attach *attach, uint64_t now_ns, const char *why);

#endif
