/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The listening socket: made at a path, or taken over from systemd
 * (LISTEN_FDS, by hand: sd_listen_fds(3) documents the protocol).
 */
#ifndef PURSUIT_LISTENER_H
#define PURSUIT_LISTENER_H

#include <stdbool.h>

#include "daemon/error.h"

struct listener {
	int fd;      /* nonblocking; -1: none */
	int lock_fd; /* path.lock, held as long as the socket exists; -1: activated */
	char path[108];
};

/*
 * `path` empty: $PURSUIT_SOCKET, else $XDG_RUNTIME_DIR/pursuit/socket, else
 * /run/pursuit/socket; the folder is made (0700) if it is missing. A socket
 * that is there already is replaced only if nobody answers. 0, or -EADDRINUSE
 * and others with a sentence.
 */
int listener_init(struct listener *listener, const char *path, struct error *error);
/* Would listener_init() with this path listen where this one does? */
bool listener_is_at(const struct listener *listener, const char *path);
/* Closes; removes the socket if listener_init() made it. */
void listener_finish(struct listener *listener);

#endif
