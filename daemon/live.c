/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/live.h"

#include <errno.h>
#include <string.h>

#include "daemon/peer.h"

enum reader {
	READER_START, /* read once */
	READER_MAIN,  /* main alone, each time that they matter */
	READER_RENDER /* the render thread, which has a copy */
};

static enum reader reader_of(const struct option_row *row)
{
	static const char *const mains[] = {
		"max-clients",  "max-frame-mb", "max-streams",  "max-client-mb",
		"max-messages", "allow-users",  "allow-groups", "log-level",
	};
	if (strcmp(row->name, "context") == 0 || strcmp(row->name, "gles") == 0 || strcmp(row->name, "threads") == 0)
		return READER_START;
	if (row->group == OPTION_ENGINE || strcmp(row->name, "governor") == 0 || strcmp(row->name, "on-client-exit") == 0)
		return READER_RENDER;
	for (size_t i = 0; i < sizeof(mains) / sizeof(mains[0]); i++)
		if (strcmp(mains[i], row->name) == 0)
			return READER_MAIN;
	return READER_START;
}

bool live_can_change(const struct option_row *row)
{
	return reader_of(row) != READER_START;
}

/* ---- what may be ---- */

static int check_method(const char *name, struct error *error)
{
	char list[256] = "";
	for (const struct engine_method_info *method = engine_methods(); method->name; method++) {
		if (strcmp(method->name, name) == 0)
			return 0;
		const size_t used = strlen(list);
		snprintf(list + used, sizeof(list) - used, "%s%s", used ? ", " : "", method->name);
	}
	return error_set(error, -EINVAL, "method: there is no method \"%.64s\"; there are %s", name, list);
}

int live_check(const struct settings *settings, struct error *error)
{
	int result = check_method(settings->method, error);
	if (result == 0)
		result = peer_check_users("allow-users", settings->allow_users, error);
	if (result == 0)
		result = peer_check_groups("allow-groups", settings->allow_groups, error);
	return result;
}

/* ---- changes ---- */

static bool differ(const struct settings *a, const struct settings *b, const struct option_row *row)
{
	char before[1024], after[1024];
	settings_get(a, row->name, before, sizeof(before));
	settings_get(b, row->name, after, sizeof(after));
	return strcmp(before, after) != 0;
}

/* Takes over what differs and can change. */
static unsigned adopt(struct live *live, const struct settings *fresh)
{
	unsigned changed = 0, for_render = 0;
	for (const struct option_row *row = option_table(); row->name; row++) {
		char before[1024], after[1024];
		struct error error;
		if (!live_can_change(row) || !differ(live->settings, fresh, row))
			continue;
		settings_get(live->settings, row->name, before, sizeof(before));
		settings_get(fresh, row->name, after, sizeof(after));
		if (settings_set(live->settings, row->name, after, &error) < 0)
			continue;
		log_info(live->log, "%s is %s now, was %s", row->name, *after ? after : "empty", *before ? before : "empty");
		for_render += reader_of(row) == READER_RENDER;
		changed++;
	}
	log_set_level(live->log, (enum log_level)live->settings->log_level);
	if (for_render && live->output)
		output_set_settings(live->output, live->settings);
	return changed;
}

unsigned live_reload(struct live *live, const struct settings *fresh)
{
	for (const struct option_row *row = option_table(); row->name; row++) {
		char before[1024], after[1024];
		if (live_can_change(row) || !differ(live->settings, fresh, row))
			continue;
		settings_get(live->settings, row->name, before, sizeof(before));
		settings_get(fresh, row->name, after, sizeof(after));
		log_warning(live->log, "%s is %s now; it stays %s until the daemon is restarted", row->name, after, before);
	}
	return adopt(live, fresh);
}

/* ---- requests ---- */

static const struct option_row *find_row(const char *name)
{
	const struct option_row *row = option_table();
	while (row->name && strcmp(row->name, name) != 0)
		row++;
	return row->name ? row : NULL;
}

/* "NAME=VALUE". */
static int set_one(struct settings *settings, char *text, bool owner, struct error *error)
{
	char values[128];
	struct error inner;
	char *equals = strchr(text, '=');
	if (!equals)
		return error_set(error, -EINVAL, "\"%.64s\" is not of the form NAME=VALUE", text);
	*equals = 0;
	const struct option_row *row = find_row(text);
	if (row && !live_can_change(row))
		return error_set(error, -EINVAL, "%s cannot change while the daemon runs; it needs a restart", row->name);
	if (row && !owner && reader_of(row) == READER_MAIN)
		return error_set(error, -EPERM, "%s is changed by the daemon's own user or root only", row->name);
	if (settings_set(settings, text, equals + 1, &inner) == 0)
		return 0;
	if (!row || row->type == OPTION_TEXT || row->type == OPTION_CHOICE)
		return error_set(error, -EINVAL, "%.400s", inner.text);
	settings_describe_values(row, values, sizeof(values));
	return error_set(error, -EINVAL, "%.300s; it may be %s", inner.text, values);
}

int live_set(struct live *live, const char *text, bool owner, struct error *error)
{
	struct settings fresh = *live->settings;
	char copy[1024], *rest = copy;
	int result = 0;
	if (strlen(text) >= sizeof(copy))
		return error_set(error, -EINVAL, "set: longer than %zu bytes", sizeof(copy) - 1);
	memcpy(copy, text, strlen(text) + 1);
	char *one = strtok_r(rest, " ", &rest);
	if (!one)
		return error_set(error, -EINVAL, "set: what? NAME=VALUE");
	for (; one && result == 0; one = strtok_r(NULL, " ", &rest))
		result = set_one(&fresh, one, owner, error);
	if (result == 0)
		result = live_check(&fresh, error);
	if (result == 0)
		adopt(live, &fresh);
	return result;
}
