/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/configuration.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char section_word[] = "application";

/* ---- profiles ---- */

void profiles_finish(struct profiles *profiles)
{
	free(profiles->list);
	*profiles = (struct profiles){.list = NULL};
}

static struct profile *find(const struct profiles *profiles, const char *application)
{
	for (size_t i = 0; i < profiles->count; i++)
		if (strcmp(profiles->list[i].application, application) == 0)
			return &profiles->list[i];
	return NULL;
}

const struct profile *profiles_find(const struct profiles *profiles, const char *application)
{
	return find(profiles, application);
}

int profile_check_name(const char *application, struct error *error)
{
	const size_t length = strlen(application);
	if (length == 0)
		return error_set(error, -EINVAL, "application: has no name");
	if (length >= EXECUTABLE_NAME_BYTES)
		return error_set(error, -EINVAL, "application: \"%.32s...\" is longer than %u bytes", application,
						 EXECUTABLE_NAME_BYTES - 1);
	for (const char *c = application; *c; c++)
		if (iscntrl((unsigned char)*c))
			return error_set(error, -EINVAL, "application: the name holds a control character (%d)", *c);
	if (strchr(application, '/'))
		return error_set(error, -EINVAL, "application: \"%.64s\" must be the name of an executable, without folders",
						 application);
	if (isspace((unsigned char)application[0]) || isspace((unsigned char)application[length - 1]))
		return error_set(error, -EINVAL, "application: \"%.64s\" begins or ends with a space", application);
	return 0;
}

/* NULL with a sentence. */
static struct profile *add(struct profiles *profiles, const char *application, struct error *error)
{
	if (profiles->count == PROFILES_MOST) {
		error_set(error, -ENOSPC, "application: \"%.64s\" is one more than the %u that may have a section", application,
				  PROFILES_MOST);
		return NULL;
	}
	struct profile *list = realloc(profiles->list, (profiles->count + 1) * sizeof(*list));
	if (!list) {
		error_set(error, -ENOMEM, "out of memory");
		return NULL;
	}
	profiles->list = list;
	struct profile *profile = &list[profiles->count++];
	memset(profile, 0, sizeof(*profile));
	settings_defaults(&profile->values);
	snprintf(profile->application, sizeof(profile->application), "%s", application);
	return profile;
}

/* ---- lines ---- */

static char *trim(char *text)
{
	char *end = text + strlen(text);
	while (isspace((unsigned char)*text))
		text++;
	while (end > text && isspace((unsigned char)end[-1]))
		*--end = 0;
	return text;
}

enum configuration_line configuration_parse(char *line, char **name, char **value)
{
	char *text = trim(line);
	const size_t length = strlen(text), word = strlen(section_word);
	*name = *value = text;
	if (!*text || *text == '#')
		return CONFIGURATION_EMPTY;
	if (*text == '[') {
		if (text[length - 1] != ']' || strncmp(text + 1, section_word, word) != 0 ||
			!isspace((unsigned char)text[1 + word]))
			return CONFIGURATION_WRONG;
		text[length - 1] = 0;
		*name = trim(text + 1 + word);
		return CONFIGURATION_SECTION;
	}
	char *equals = strchr(text, '=');
	if (!equals)
		return CONFIGURATION_WRONG;
	*equals = 0;
	*name = trim(text);
	*value = trim(equals + 1);
	return CONFIGURATION_SETTING;
}

struct reading {
	struct settings *settings;
	struct profiles *profiles;
	struct profile *profile; /* whose section it is; NULL: before the first */
	unsigned line;
	configuration_check check;
};

static int begin_section(struct reading *reading, const char *application, struct error *error)
{
	const int result = profile_check_name(application, error);
	if (result < 0)
		return result;
	reading->profile = find(reading->profiles, application);
	if (reading->profile && reading->profile->line)
		return error_set(error, -EINVAL, "application %s has a section already, at line %u", application,
						 reading->profile->line);
	if (!reading->profile)
		reading->profile = add(reading->profiles, application, error);
	if (!reading->profile)
		return -ENOMEM;
	reading->profile->line = reading->line;
	return 0;
}

static int take_setting(struct reading *reading, const char *name, const char *value, struct error *error)
{
	const struct option_row *row = option_find(name);
	struct profile *profile = reading->profile;
	struct settings *settings = profile ? &profile->values : reading->settings;
	if (profile && row && !option_is_of_picture(row))
		return error_set(
			error, -EINVAL,
			"%s is no setting of the picture, which alone an application may have; move it above the first "
			"section",
			name);
	int result = settings_set(settings, name, value, error);
	if (result == 0 && reading->check)
		result = reading->check(row, settings, error);
	if (result == 0 && profile)
		profile->has[row - option_table()] = true;
	else if (result == 0)
		reading->profiles->lines[row - option_table()] = reading->line;
	return result;
}

static int take_line(struct reading *reading, char *line, struct error *error)
{
	char *name, *value;
	switch (configuration_parse(line, &name, &value)) {
	case CONFIGURATION_EMPTY:
		return 0;
	case CONFIGURATION_SECTION:
		return begin_section(reading, name, error);
	case CONFIGURATION_SETTING:
		return take_setting(reading, name, value, error);
	case CONFIGURATION_WRONG:
		break;
	}
	return error_set(error, -EINVAL, "\"%.64s\" is not of the form %s", name,
					 *name == '[' ? "[application NAME]" : "name = value");
}

int configuration_read(struct settings *settings, struct profiles *profiles, FILE *file, const char *path,
					   configuration_check check, struct error *error)
{
	struct reading reading = {.settings = settings, .profiles = profiles, .check = check};
	char *line = NULL;
	size_t size = 0;
	ssize_t length;
	int result = 0;
	for (size_t i = 0; i < profiles->count; i++)
		profiles->list[i].line = 0;
	memset(profiles->lines, 0, sizeof(profiles->lines));
	errno = 0;
	while (result == 0 && (length = getline(&line, &size, file)) >= 0) {
		struct error inner;
		reading.line++;
		if (strlen(line) != (size_t)length)
			result = error_set(error, -EINVAL, "%s:%u: holds a zero byte; is it a text file?", path, reading.line);
		else if ((result = take_line(&reading, line, &inner)) < 0)
			error_set(error, result, "%s:%u: %.400s", path, reading.line, inner.text);
	}
	if (result == 0 && ferror(file))
		result = error_set(error, errno ? -errno : -EIO, "%s: %s", path, strerror(errno ? errno : EIO));
	free(line);
	return result;
}

int configuration_load(struct settings *settings, struct profiles *profiles, const char *path,
					   configuration_check check, struct error *error)
{
	FILE *file = fopen(path, "re");
	if (!file)
		return error_set(error, -errno, "%s: %s", path, strerror(errno));
	const int result = configuration_read(settings, profiles, file, path, check, error);
	fclose(file);
	return result;
}

/* ---- defaults ---- */

void configuration_print(FILE *out)
{
	static const char *const titles[] = {"Engine", "Output", "Lab (docs/lab.md)", "Daemon"};
	int group = -1;
	fprintf(out, "# Settings of pursuitd, one `name = value` a line; these are the defaults.\n");
	for (const struct option_row *row = option_table(); row->name; row++) {
		char range[160];
		if ((int)row->group != group) {
			group = (int)row->group;
			fprintf(out, "\n# ---- %s ----\n", titles[group]);
		}
		settings_describe_values(row, range, sizeof(range));
		fprintf(out, "\n# %s\n# (%s)\n#%s = %s\n", row->help, range, row->name, row->default_value);
	}
	fprintf(out,
			"\n# ---- Applications ----\n"
			"\n# Settings of the picture that hold while a client of this executable is shown. Sections come last;\n"
			"# `pursuit profile` writes them.\n"
			"#\n"
			"#     [application supertux2]\n"
			"#     method = grid\n"
			"#     blur = everywhere\n");
}
