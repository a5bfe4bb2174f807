/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Files that a running daemon is told to write: to open a pipe that nobody reads waits for a reader. */
#ifndef PURSUIT_OPEN_AT_ONCE_H
#define PURSUIT_OPEN_AT_ONCE_H

#include <errno.h>
#include <fcntl.h>
#include <string.h>

#include "daemon/error.h"

/*
 * For writing, made if it is not there, with these flags beside; what is written waits as ever. The fd, or a negative
 * errno with a sentence that names the option: a pipe that nobody reads is -ENXIO.
 */
static inline int open_at_once(const char *option, const char *path, int flags, struct error *error)
{
	const int fd = open(path, O_WRONLY | O_CREAT | O_NONBLOCK | O_CLOEXEC | flags, 0666);
	if (fd < 0)
		return error_set(error, -errno, "%s: %.300s: %s%s", option, path, strerror(errno),
						 errno == ENXIO ? "; nobody reads the pipe" : "");
	const int now = fcntl(fd, F_GETFL);
	if (now >= 0)
		fcntl(fd, F_SETFL, now & ~O_NONBLOCK);
	return fd;
}

#endif
