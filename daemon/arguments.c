/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/arguments.h"

#include <errno.h>
#include <string.h>

#include "daemon/setting_check.h"

static int load(struct arguments *arguments, const char *path, struct error *error)
{
	const bool may_be_missing = *path == '-';
	path += may_be_missing;
	if (arguments->file_count == ARGUMENTS_FILES)
		return error_set(error, -EINVAL, "--config %s is one more than the %u files that there may be", path,
						 ARGUMENTS_FILES);
	arguments->files[arguments->file_count++] = path;
	const int result = configuration_load(&arguments->settings, &arguments->profiles, path, setting_check, error);
	for (unsigned i = 0; result == 0 && i < OPTION_ROWS; i++)
		if (arguments->profiles.lines[i])
			arguments->origins[i] = (struct origin){ORIGIN_FILE, path, arguments->profiles.lines[i]};
	return result == -ENOENT && may_be_missing ? 0 : result;
}

/* "--config FILE" and "--config=FILE": 1 taken, 0 not it, negative: refused with a sentence. */
static int take_config(struct arguments *arguments, int argc, char **argv, int *index, struct error *error)
{
	const char *path;
	if (strncmp(argv[*index], "--config=", 9) == 0)
		path = argv[*index] + 9;
	else if (strcmp(argv[*index], "--config") != 0)
		return 0;
	else if (*index + 1 >= argc)
		return error_set(error, -EINVAL, "--config needs a file");
	else
		path = argv[++*index];
	const int result = load(arguments, path, error);
	return result < 0 ? result : 1;
}

static int take_option(struct arguments *arguments, int argc, char **argv, int *index, struct error *error)
{
	const struct option_row *row = settings_argument_row(argv[*index]);
	const int taken = settings_argument(&arguments->settings, ALL_GROUPS, argc, argv, index, error);
	if (taken == 1 && row)
		arguments->origins[row - option_table()] = (struct origin){.kind = ORIGIN_COMMAND_LINE};
	return taken;
}

static int refuse(const char *argument, struct error *error)
{
	char name[64];
	const char *nearest = NULL;
	if (strncmp(argument, "--", 2) == 0) {
		snprintf(name, sizeof(name), "%.*s", (int)strcspn(argument + 2, "="), argument + 2);
		nearest = settings_nearest(name);
	}
	return error_set(error, -EINVAL, "%.100s: there is no such option%s%s%s", argument,
					 nearest ? "; did you mean --" : "", nearest ? nearest : "", nearest ? "?" : "");
}

int arguments_read(struct arguments *arguments, int argc, char **argv, struct error *error)
{
	memset(arguments, 0, sizeof(*arguments));
	settings_defaults(&arguments->settings);
	for (int i = 1; i < argc; i++) {
		int taken = take_config(arguments, argc, argv, &i, error);
		if (taken == 0)
			taken = take_option(arguments, argc, argv, &i, error);
		if (taken < 0)
			return taken;
		if (taken == 0)
			return refuse(argv[i], error);
	}
	return setting_check_all(&arguments->settings, error);
}

void arguments_finish(struct arguments *arguments)
{
	profiles_finish(&arguments->profiles);
}

void origins_tell(const struct origin *origins, struct error *error)
{
	const struct error before = *error;
	for (const struct option_row *row = option_table(); row->name; row++) {
		const struct origin *origin = &origins[row - option_table()];
		const size_t length = strlen(row->name);
		if (origin->kind == ORIGIN_FILE && strncmp(before.text, row->name, length) == 0 && before.text[length] == ':')
			error_set(error, 0, "%s:%u: %.400s", origin->file, origin->line, before.text);
	}
}
