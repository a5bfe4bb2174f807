/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/aside.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define NUMBERS 100000u

static bool holds_something(const char *path)
{
	struct stat status;
	return *path && stat(path, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0;
}

/* 0, -EEXIST if the name is taken, or another negative errno. */
static int move(const char *from, const char *to)
{
	if (renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0)
		return 0;
	/* File systems that cannot say so in one go. */
	if (errno != EINVAL && errno != ENOSYS)
		return -errno;
	if (access(to, F_OK) == 0)
		return -EEXIST;
	return rename(from, to) == 0 ? 0 : -errno;
}

int aside_put(const char *option, const char *path, const struct log *log, struct aside *aside, struct error *error)
{
	char to[ASIDE_PATH_BYTES + 16];
	struct stat status;
	int result = -EEXIST;
	if (aside && strlen(path) < ASIDE_PATH_BYTES) {
		*aside = (struct aside){.absent = *path && lstat(path, &status) < 0 && errno == ENOENT};
		snprintf(aside->path, sizeof(aside->path), "%s", path);
	}
	if (!holds_something(path))
		return 0;
	if (strlen(path) >= ASIDE_PATH_BYTES)
		return error_set(error, -ENAMETOOLONG, "%s: %.64s...: the path is too long", option, path);
	for (unsigned i = 1; i < NUMBERS && result == -EEXIST; i++) {
		snprintf(to, sizeof(to), "%s.%u", path, i);
		result = move(path, to);
	}
	if (result < 0)
		return error_set(error, result, "%s: %s is there and cannot be put aside: %s", option, path, strerror(-result));
	log_info(log, "%s: %s was there; it is %s now", option, path, to);
	if (aside)
		memcpy(aside->kept, to, sizeof(aside->kept));
	return 0;
}

void aside_take_back(struct aside *aside, const struct log *log)
{
	struct stat status;
	if (*aside->kept && rename(aside->kept, aside->path) == 0)
		log_info(log, "%s is back", aside->path);
	else if (*aside->kept)
		log_warning(log, "%s stays %s: %s", aside->path, aside->kept, strerror(errno));
	else if (aside->absent && lstat(aside->path, &status) == 0 && S_ISREG(status.st_mode))
		unlink(aside->path);
	*aside = (struct aside){.absent = false};
}
