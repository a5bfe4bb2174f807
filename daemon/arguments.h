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

/* Where a setting that is no application's comes from. */
enum origin_kind {
	ORIGIN_DEFAULT = 0,
	ORIGIN_FILE,
	ORIGIN_COMMAND_LINE,
};

struct origin {
	enum origin_kind kind;
	const char *file; /* of ORIGIN_FILE: points into argv */
	unsigned line;
};

struct arguments {
	struct origin origins[OPTION_ROWS]; /* by the place of the row */
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

/*
 * Puts file and line in front of a sentence that begins with the name of a setting and a colon, if the value came from
 * a file; for what is found wrong with a value only when it is used. `origins`: by the place of the row.
 */
void origins_tell(const struct origin *origins, struct error *error);

#endif
