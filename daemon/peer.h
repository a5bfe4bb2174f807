/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Who may be a client: users and groups, by name or number, separated by
 * commas. With both lists empty everybody who can reach the socket may, since
 * its folder has permissions of its own. The daemon's own user always may.
 */
#ifndef PURSUIT_PEER_H
#define PURSUIT_PEER_H

#include <stdbool.h>
#include <sys/types.h>

#include "daemon/error.h"

struct peer {
	pid_t pid; /* 0 unknown */
	uid_t uid; /* (uid_t)-1 unknown: allowed nothing */
	gid_t gid;
};

/* What the kernel says of the other end of a connection. */
struct peer peer_of(int socket);

/*
 * The process that connected `socket`, with this number, as a pidfd, which is readable once it has ended; the caller's.
 * -1: it has ended, or may not be known. Before Linux 6.5 it is the process that has the number now.
 */
int peer_open_process(int socket, pid_t pid);

/* Are all names known? 0 or -EINVAL with a sentence that names the setting (`option`). */
int peer_check_users(const char *option, const char *users, struct error *error);
int peer_check_groups(const char *option, const char *groups, struct error *error);

/* `socket` tells the peer's other groups. Names that are not known allow nobody. */
bool peer_allowed(const struct peer *peer, int socket, const char *users, const char *groups);

/* The daemon's own user, or root: may do to the daemon what would otherwise take away from the others. */
bool peer_is_owner(const struct peer *peer);

#endif
