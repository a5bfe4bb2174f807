/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/setting_check.h"

#include <errno.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "daemon/present/presenter.h"
#include "daemon/record/pattern.h"

/* Pipes and devices may be called as they like. */
static int check_tee(const char *option, const char *path, struct error *error)
{
	static const char ending[] = ".y4m";
	const size_t length = strlen(path), least = strlen(ending);
	struct stat status;
	if (strchr(path, '%'))
		return pattern_check_written(option, path, ".png", error);
	if (length == 0 || (length >= least && strcasecmp(path + length - least, ending) == 0))
		return 0;
	if (stat(path, &status) == 0 && !S_ISREG(status.st_mode))
		return 0;
	return error_set(error, -EINVAL,
					 "%s: '%s': must end in %s, the format that is written, or be a name like 'out/%%06d.png'", option,
					 path, ending);
}

int setting_check(const struct option_row *row, const struct settings *settings, struct error *error)
{
	if (strcmp(row->name, "present") == 0)
		return presenter_check_list(settings->present, error);
	if (strcmp(row->name, "tee") == 0)
		return check_tee(row->name, settings->tee, error);
	return 0;
}

int setting_check_all(const struct settings *settings, struct error *error)
{
	int result = 0;
	for (const struct option_row *row = option_table(); row->name && result == 0; row++)
		result = setting_check(row, settings, error);
	return result;
}
