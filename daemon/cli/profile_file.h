/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A configuration file whose sections of applications are changed line by line:
 * all other lines, comments among them, stay as they are. It is replaced whole
 * (written beside itself, synced, renamed), and only by text that the daemon
 * would take; two that change it at once wait for each other.
 */
#ifndef PURSUIT_CLI_PROFILE_FILE_H
#define PURSUIT_CLI_PROFILE_FILE_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#include "daemon/configuration.h"
#include "daemon/error.h"

struct profile_file {
	char path[PATH_MAX]; /* where links have led to */
	char **lines;        /* without their ends */
	size_t count;
	bool there;
	mode_t mode;
	uid_t uid;
	gid_t gid;
	int folder_fd;            /* locked, -1 if not to be changed */
	struct profiles profiles; /* as they were read */
};

/*
 * Reads it. One that is not there is empty; for `change` its folders are made. 0, or a negative errno with a sentence,
 * which names the line where the file has a mistake already.
 */
int profile_file_open(struct profile_file *file, const char *path, bool change, struct error *error);
void profile_file_close(struct profile_file *file);

/* 0 or -ENOMEM. */
int profile_file_set(struct profile_file *file, const char *application, const char *name, const char *value);
/* Is there such a line, or such a section? Takes it out. */
bool profile_file_unset(struct profile_file *file, const char *application, const char *name);
bool profile_file_remove(struct profile_file *file, const char *application);

/* 0, or a negative errno with a sentence; then the file is as it was. */
int profile_file_save(struct profile_file *file, struct error *error);

#endif
