/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/peer.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Linux 6.5; headers that are older do not name it. */
#define PEER_PIDFD 77
/* As many as Linux lets a process have. */
#define MOST_GROUPS 65536u
#define NAME_BYTES 64

struct peer peer_of(int socket)
{
	struct ucred credentials;
	socklen_t size = sizeof(credentials);
	if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &credentials, &size) < 0)
		return (struct peer){0, (uid_t)-1, (gid_t)-1};
	return (struct peer){credentials.pid, credentials.uid, credentials.gid};
}

int peer_open_process(int socket, pid_t pid)
{
	int process = -1;
	socklen_t size = sizeof(process);
	if (pid <= 0)
		return -1;
	if (getsockopt(socket, SOL_SOCKET, PEER_PIDFD, &process, &size) == 0)
		return process;
	/* Only where there is no such option: up to Linux 6.15 it fails when the peer has ended, and its number is reused.
	 */
	return errno == ENOPROTOOPT ? (int)syscall(SYS_pidfd_open, pid, 0) : -1;
}

/* ---- lists ---- */

/* The next word of a comma-separated list; false at its end. Words that are too long are cut, and known to nobody. */
static bool next_word(const char **list, char word[NAME_BYTES])
{
	*list += strspn(*list, ", ");
	const size_t length = strcspn(*list, ", ");
	if (length == 0)
		return false;
	snprintf(word, NAME_BYTES, "%.*s", (int)length, *list);
	*list += length;
	return true;
}

static bool number_of(const char *word, unsigned long *number)
{
	char *end;
	errno = 0;
	*number = strtoul(word, &end, 10);
	return *word >= '0' && *word <= '9' && !*end && errno == 0 && *number < UINT32_MAX;
}

static bool user_of(const char *word, uid_t *uid)
{
	unsigned long number;
	const struct passwd *entry;
	if (number_of(word, &number)) {
		*uid = (uid_t)number;
		return true;
	}
	entry = getpwnam(word);
	if (entry)
		*uid = entry->pw_uid;
	return entry != NULL;
}

static bool group_of(const char *word, gid_t *gid)
{
	unsigned long number;
	const struct group *entry;
	if (number_of(word, &number)) {
		*gid = (gid_t)number;
		return true;
	}
	entry = getgrnam(word);
	if (entry)
		*gid = entry->gr_gid;
	return entry != NULL;
}

int peer_check_users(const char *option, const char *users, struct error *error)
{
	char word[NAME_BYTES];
	uid_t uid;
	while (next_word(&users, word))
		if (!user_of(word, &uid))
			return error_set(error, -EINVAL, "%s: there is no user \"%s\"", option, word);
	return 0;
}

int peer_check_groups(const char *option, const char *groups, struct error *error)
{
	char word[NAME_BYTES];
	gid_t gid;
	while (next_word(&groups, word))
		if (!group_of(word, &gid))
			return error_set(error, -EINVAL, "%s: there is no group \"%s\"", option, word);
	return 0;
}

/* ---- one peer ---- */

static bool is_user(const struct peer *peer, const char *users)
{
	char word[NAME_BYTES];
	uid_t uid;
	while (next_word(&users, word))
		if (user_of(word, &uid) && uid == peer->uid)
			return true;
	return false;
}

/* The groups that the peer had when it connected, its first one aside. To be freed; NULL: none, or not told. */
static gid_t *other_groups(int socket, size_t *count)
{
	socklen_t bytes = 0;
	gid_t *groups = NULL;
	*count = 0;
	/* Without room the kernel says how much it takes. */
	if (getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, NULL, &bytes) == 0 || errno != ERANGE)
		return NULL;
	if (bytes <= MOST_GROUPS * sizeof(gid_t))
		groups = malloc(bytes);
	if (groups && getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups, &bytes) == 0)
		*count = bytes / sizeof(gid_t);
	return groups;
}

static bool is_member(const struct peer *peer, int socket, const char *list)
{
	char word[NAME_BYTES];
	size_t count;
	gid_t gid, *groups = other_groups(socket, &count);
	bool member = false;
	while (!member && next_word(&list, word)) {
		if (!group_of(word, &gid))
			continue;
		member = gid == peer->gid;
		for (size_t i = 0; i < count && !member; i++)
			member = groups[i] == gid;
	}
	free(groups);
	return member;
}

bool peer_is_owner(const struct peer *peer)
{
	return peer->uid == 0 || peer->uid == geteuid();
}

bool peer_allowed(const struct peer *peer, int socket, const char *users, const char *groups)
{
	if (!*users && !*groups)
		return true;
	if (peer->uid == (uid_t)-1)
		return false;
	return peer->uid == geteuid() || is_user(peer, users) || is_member(peer, socket, groups);
}
