/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The configuration file: `name = value` lines, # in front of comments, and
 * sections of applications that hold while a client of that executable is shown:
 *
 *   method = pursuit
 *
 *   [application supertux2]
 *   blur = everywhere
 *
 * A section holds settings of the picture only (option_is_of_picture()).
 */
#ifndef PURSUIT_CONFIGURATION_H
#define PURSUIT_CONFIGURATION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "daemon/error.h"
#include "daemon/executable.h"
#include "daemon/options.h"

#define PROFILES_MOST 256u

struct profile {
	char application[EXECUTABLE_NAME_BYTES]; /* name of the executable, without folders */
	unsigned line;                           /* of its section in the file read last; 0: it has none there */
	struct settings values;                  /* defaults where not `has` */
	bool has[OPTION_ROWS];                   /* by the place of the row */
};

/* Zeroed: none. */
struct profiles {
	struct profile *list;
	size_t count;
	unsigned lines[OPTION_ROWS]; /* of the settings before the first section of the file read last; 0: not there */
};

void profiles_finish(struct profiles *profiles);

/* NULL: it has none. */
const struct profile *profiles_find(const struct profiles *profiles, const char *application);

/* May an application be called so in a file? 0 or -EINVAL with a sentence. */
int profile_check_name(const char *application, struct error *error);

/* Says of a setting that was just read what its type cannot know (setting_check.h): 0, or -EINVAL with a sentence. */
typedef int (*configuration_check)(const struct option_row *row, const struct settings *settings, struct error *error);

/*
 * Reads text on top of what the settings and profiles hold already; what comes later counts. check may be NULL. 0, or
 * a negative errno with a sentence that names path and line: then both are half filled, and to be thrown away.
 */
int configuration_read(struct settings *settings, struct profiles *profiles, FILE *file, const char *path,
					   configuration_check check, struct error *error);

/* The same from a file. -ENOENT where there is none. */
int configuration_load(struct settings *settings, struct profiles *profiles, const char *path,
					   configuration_check check, struct error *error);

/*
 * What a line is, for those who edit files; the line (without its end) is taken apart in place. *name is the
 * application's or the setting's, *value the text behind the equals sign.
 */
enum configuration_line {
	CONFIGURATION_EMPTY, /* or a comment */
	CONFIGURATION_SECTION,
	CONFIGURATION_SETTING,
	CONFIGURATION_WRONG,
};
enum configuration_line configuration_parse(char *line, char **name, char **value);

/* A file with all settings commented, as they are by default. */
void configuration_print(FILE *out);

#endif
