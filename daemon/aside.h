/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#ifndef PURSUIT_ASIDE_H
#define PURSUIT_ASIDE_H

#include <stdbool.h>

#include "daemon/error.h"
#include "daemon/log.h"

#define ASIDE_PATH_BYTES 1024u

/* What can be taken back if the file is not written after all. Zeroed: nothing. */
struct aside {
	char path[ASIDE_PATH_BYTES];
	char kept[ASIDE_PATH_BYTES + 16]; /* where it was put; "": nothing was */
	bool absent;                      /* there was no file at all */
};

/*
 * A daemon that was killed is started again with the options that it had, and must not write over what it measured
 * before: a file that holds something is renamed to PATH.1, .2 and so on, the first that is free, and that is logged.
 * Devices, pipes, empty files and an empty path are left alone. 0, or a negative errno with a sentence that names the
 * option. `aside` (NULL: it is for good) tells aside_take_back() what was done.
 */
int aside_put(const char *option, const char *path, const struct log *log, struct aside *aside, struct error *error);

/* What was there is there again, in place of what was made since. Clears it. */
void aside_take_back(struct aside *aside, const struct log *log);

#endif
