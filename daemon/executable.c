/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/executable.h"

#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Linux 6.5; headers that are older do not name it. */
#define PEER_PIDFD 77

static const char deleted[] = " (deleted)";

/* The process that connected, even if its number is another's by now; before Linux 6.5 the one that has it now. */
static int open_process(int socket, pid_t pid)
{
	int process = -1;
	socklen_t size = sizeof(process);
	if (getsockopt(socket, SOL_SOCKET, PEER_PIDFD, &process, &size) == 0)
		return process;
	return (int)syscall(SYS_pidfd_open, pid, 0);
}

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
	const int process = pid > 0 ? open_process(socket, pid) : -1;
	*name = 0;
	if (process < 0)
		return false;
	const bool known = read_name(pid, name) && is_alive(process);
	close(process);
	if (!known)
		*name = 0;
	return known;
}
