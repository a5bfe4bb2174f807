/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/executable.h"

#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/peer.h"

static const char deleted[] = " (deleted)";

static bool is_alive(int process)
{
	struct pollfd wait = {.fd = process, .events = POLLIN};
	return poll(&wait, 1, 0) == 0;
}

/* The kernel adds a word to the path of a file that is gone; a file may also really be called so. */
static void take_word_off(const char *link, char *path)
{
	const size_t length = strlen(path), word = strlen(deleted);
	struct stat file;
	if (length > word && strcmp(path + length - word, deleted) == 0 && stat(link, &file) == 0 && file.st_nlink == 0)
		path[length - word] = 0;
}

static bool read_name(pid_t pid, char name[EXECUTABLE_NAME_BYTES])
{
	char link[32], path[PATH_MAX + 16];
	snprintf(link, sizeof(link), "/proc/%d/exe", (int)pid);
	const ssize_t length = readlink(link, path, sizeof(path) - 1);
	if (length <= 0)
		return false;
	path[length] = 0;
	take_word_off(link, path);
	const char *slash = strrchr(path, '/');
	const char *last = slash ? slash + 1 : path;
	if (!*last || strlen(last) >= EXECUTABLE_NAME_BYTES)
		return false;
	memcpy(name, last, strlen(last) + 1);
	return true;
}

bool executable_of(int socket, pid_t pid, char name[EXECUTABLE_NAME_BYTES])
{
	const int process = peer_open_process(socket, pid);
	*name = 0;
	if (process < 0)
		return false;
	const bool known = read_name(pid, name) && is_alive(process);
	close(process);
	if (!known)
		*name = 0;
	return known;
}
