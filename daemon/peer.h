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
#include <stdint.h>
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

/* As many words as a setting has room for. */
#define PEER_MOST 128u

/* Who may be a client, by the numbers that the kernel knows. */
struct peer_list {
	bool everybody;
	uint32_t user_count, group_count;
	uid_t users[PEER_MOST];
	gid_t groups[PEER_MOST];
};

/* Is there one that is no number, and must be looked up? */
bool peer_has_names(const char *words);

/*
 * The numbers of both settings. Names are looked up where the machine is set up to: where that is a server it may take
 * for ever. Any thread. 0, or a negative errno with a sentence that names setting and name: there is none (-EINVAL), or
 * nobody could tell.
 */
int peer_look_up(const char *users, const char *groups, struct peer_list *list, struct error *error);

/* `socket` tells the peer's other groups. */
bool peer_allowed(const struct peer *peer, int socket, const struct peer_list *list);

/* The daemon's own user, or root: may do to the daemon what would otherwise take away from the others. */
bool peer_is_owner(const struct peer *peer);

#endif
