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
/* Of what is known of a user or a group, its members included. */
#define MOST_ROOM (1u << 22)

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
	/* Only where there is no such option: up to Linux 6.15 it fails once the peer has ended; its number is reused. */
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

bool peer_has_names(const char *words)
{
	char word[NAME_BYTES];
	unsigned long number;
	while (next_word(&words, word))
		if (!number_of(word, &number))
			return true;
	return false;
}

/*
 * Calls one of the next two with more and more room. 0 with the number, -ENOENT: there is none, or why it is not known.
 */
static int look_up(int (*find)(const char *name, char *room, size_t size, uint32_t *number), const char *name,
				   uint32_t *number)
{
	int result = -ERANGE;
	for (size_t size = 1024; result == -ERANGE && size <= MOST_ROOM; size *= 4) {
		char *room = malloc(size);
		result = room ? find(name, room, size, number) : -ENOMEM;
		free(room);
	}
	return result == -ESRCH ? -ENOENT : result;
}

static int find_user(const char *name, char *room, size_t size, uint32_t *number)
{
	struct passwd entry, *found = NULL;
	const int result = getpwnam_r(name, &entry, room, size, &found);
	if (found)
		*number = entry.pw_uid;
	return found ? 0 : result ? -result : -ENOENT;
}

static int find_group(const char *name, char *room, size_t size, uint32_t *number)
{
	struct group entry, *found = NULL;
	const int result = getgrnam_r(name, &entry, room, size, &found);
	if (found)
		*number = entry.gr_gid;
	return found ? 0 : result ? -result : -ENOENT;
}

static int look_up_words(bool groups, const char *words, uint32_t numbers[PEER_MOST], uint32_t *count,
						 struct error *error)
{
	const char *option = groups ? "allow-groups" : "allow-users", *kind = groups ? "group" : "user";
	char word[NAME_BYTES];
	for (*count = 0; *count < PEER_MOST && next_word(&words, word); (*count)++) {
		unsigned long number;
		int result = 0;
		if (number_of(word, &number))
			numbers[*count] = (uint32_t)number;
		else if (strlen(word) == NAME_BYTES - 1)
			result = -ENOENT; /* it was cut */
		else
			result = look_up(groups ? find_group : find_user, word, &numbers[*count]);
		if (result == -ENOENT)
			return error_set(error, -EINVAL, "%s: there is no %s \"%s\"", option, kind, word);
		if (result < 0)
			return error_set(error, result, "%s: the %s \"%s\" cannot be looked up: %s", option, kind, word,
							 strerror(-result));
	}
	return 0;
}

int peer_look_up(const char *users, const char *groups, struct peer_list *list, struct error *error)
{
	_Static_assert(sizeof(uid_t) == sizeof(uint32_t) && sizeof(gid_t) == sizeof(uint32_t), "as Linux has them");
	list->everybody = !*users && !*groups;
	const int result = look_up_words(false, users, list->users, &list->user_count, error);
	return result < 0 ? result : look_up_words(true, groups, list->groups, &list->group_count, error);
}

/* ---- one peer ---- */

static bool is_user(const struct peer *peer, const struct peer_list *list)
{
	for (uint32_t i = 0; i < list->user_count; i++)
		if (list->users[i] == peer->uid)
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

static bool has_group(const struct peer_list *list, gid_t gid)
{
	for (uint32_t i = 0; i < list->group_count; i++)
		if (list->groups[i] == gid)
			return true;
	return false;
}

static bool is_member(const struct peer *peer, int socket, const struct peer_list *list)
{
	bool member = has_group(list, peer->gid);
	size_t count = 0;
	gid_t *groups = member || list->group_count == 0 ? NULL : other_groups(socket, &count);
	for (size_t i = 0; i < count && !member; i++)
		member = has_group(list, groups[i]);
	free(groups);
	return member;
}

bool peer_is_owner(const struct peer *peer)
{
	return peer->uid == 0 || peer->uid == geteuid();
}

bool peer_allowed(const struct peer *peer, int socket, const struct peer_list *list)
{
	if (list->everybody)
		return true;
	if (peer->uid == (uid_t)-1)
		return false;
	return peer->uid == geteuid() || is_user(peer, list) || is_member(peer, socket, list);
}
