/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What pursuitd was told: its command line with the files that it names, and what they make of the settings. */
#ifndef PURSUIT_ARGUMENTS_H
#define PURSUIT_ARGUMENTS_H

#include "daemon/configuration.h"
#include "daemon/error.h"
#include "daemon/options.h"

#define ARGUMENTS_FILES 8u
#define ALL_GROUPS (1u << OPTION_ENGINE | 1u << OPTION_OUTPUT | 1u << OPTION_LAB | 1u << OPTION_DAEMON)

struct arguments {
	struct settings settings;
	struct profiles profiles;
	const char *files[ARGUMENTS_FILES]; /* in the order of reading; point into argv */
	unsigned file_count;
};

/*
 * Defaults, then options and files in their order; a FILE with a minus in front need not be there. 0, or -EINVAL with
 * a sentence. `files` are right either way; the rest is to be used after 0 only.
 */
int arguments_read(struct arguments *arguments, int argc, char **argv, struct error *error);
void arguments_finish(struct arguments *arguments);

#endif
