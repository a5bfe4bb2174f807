/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/live.h"

#include <errno.h>
#include <string.h>

#include "daemon/setting_check.h"

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
	if (option_is_of_picture(row) || strcmp(row->name, "on-client-exit") == 0)
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

/* ---- life ---- */

void live_init(struct live *live, struct settings *settings, struct profiles *profiles, struct log *log)
{
	*live = (struct live){.settings = settings, .log = log, .base = *settings, .profiles = *profiles};
	live->asked = *settings;
	*profiles = (struct profiles){NULL, 0};
}

void live_finish(struct live *live)
{
	profiles_finish(&live->profiles);
}

const struct profile *live_profile(const struct live *live)
{
	return *live->application ? profiles_find(&live->profiles, live->application) : NULL;
}

/* ---- changes ---- */

static bool differ(const struct settings *a, const struct settings *b, const struct option_row *row)
{
	char before[1024], after[1024];
	settings_get(a, row->name, before, sizeof(before));
	settings_get(b, row->name, after, sizeof(after));
	return strcmp(before, after) != 0;
}

static void copy(struct settings *to, const struct settings *from, const struct option_row *row)
{
	char value[1024];
	struct error error;
	settings_get(from, row->name, value, sizeof(value));
	settings_set(to, row->name, value, &error);
}

/* Where the setting comes from now. */
static const struct settings *source_of(const struct live *live, const struct option_row *row)
{
	const size_t place = (size_t)(row - option_table());
	const struct profile *profile = live_profile(live);
	if (live->is_asked[place])
		return &live->asked;
	return profile && profile->has[place] ? &profile->values : &live->base;
}

/* Brings the settings in force up to date. Gives how many changed; *for_render: those that the render thread reads. */
static unsigned settle(struct live *live, unsigned *for_render)
{
	unsigned changed = 0;
	*for_render = 0;
	for (const struct option_row *row = option_table(); row->name; row++) {
		const struct settings *source = source_of(live, row);
		char before[1024], after[1024];
		if (!live_can_change(row) || !differ(live->settings, source, row))
			continue;
		settings_get(live->settings, row->name, before, sizeof(before));
		settings_get(source, row->name, after, sizeof(after));
		copy(live->settings, source, row);
		log_info(live->log, "%s is %s now, was %s", row->name, *after ? after : "empty", *before ? before : "empty");
		*for_render += reader_of(row) == READER_RENDER;
		changed++;
	}
	if (live->log)
		log_set_level(live->log, (enum log_level)live->settings->log_level);
	return changed;
}

static unsigned settle_and_tell(struct live *live)
{
	unsigned for_render;
	const unsigned changed = settle(live, &for_render);
	if (for_render && live->output)
		output_set_settings(live->output, live->settings);
	return changed;
}

static void tell_of_others(const struct live *live, const struct settings *fresh)
{
	for (const struct option_row *row = option_table(); row->name; row++) {
		char before[1024], after[1024];
		if (!differ(&live->base, fresh, row))
			continue;
		settings_get(live->settings, row->name, before, sizeof(before));
		settings_get(fresh, row->name, after, sizeof(after));
		if (!live_can_change(row))
			log_warning(live->log, "%s is %s now; it stays %s until the daemon is restarted", row->name, after, before);
		else if (live->is_asked[row - option_table()])
			log_info(live->log, "%s is %s now in the configuration; it stays %s, as `pursuit set` asked for", row->name,
					 after, before);
	}
}

unsigned live_reload(struct live *live, const struct settings *fresh, struct profiles *profiles)
{
	tell_of_others(live, fresh);
	for (const struct option_row *row = option_table(); row->name; row++)
		if (live_can_change(row))
			copy(&live->base, fresh, row);
	profiles_finish(&live->profiles);
	live->profiles = *profiles;
	*profiles = (struct profiles){NULL, 0};
	return settle_and_tell(live);
}

const struct settings *live_show(void *data, const char *application)
{
	struct live *live = data;
	unsigned for_render;
	if (strcmp(live->application, application) == 0)
		return NULL;
	snprintf(live->application, sizeof(live->application), "%s", application);
	if (live_profile(live))
		log_info(live->log, "settings of application %s", application);
	settle(live, &for_render);
	return for_render ? live->settings : NULL;
}

/* ---- requests ---- */

static int check_right(const struct option_row *row, bool owner, struct error *error)
{
	if (!live_can_change(row))
		return error_set(error, -EINVAL, "%s cannot change while the daemon runs; it needs a restart", row->name);
	if (!owner && reader_of(row) == READER_MAIN)
		return error_set(error, -EPERM, "%s is changed by the daemon's own user or root only", row->name);
	return 0;
}

/* What requests change until they turn out to be right. */
struct wish {
	struct settings asked;
	bool is_asked[OPTION_ROWS];
	bool owner;
};

/* "NAME=VALUE". */
static int set_one(struct wish *wish, char *text, struct error *error)
{
	char values[128];
	struct error inner;
	char *equals = strchr(text, '=');
	if (!equals)
		return error_set(error, -EINVAL, "\"%.64s\" is not of the form NAME=VALUE", text);
	*equals = 0;
	const struct option_row *row = option_find(text);
	const int result = row ? check_right(row, wish->owner, error) : 0;
	if (result < 0)
		return result;
	if (settings_set(&wish->asked, text, equals + 1, &inner) == 0) {
		wish->is_asked[row - option_table()] = true;
		return setting_check(row, &wish->asked, error);
	}
	if (!row || row->type == OPTION_TEXT || row->type == OPTION_CHOICE)
		return error_set(error, -EINVAL, "%.400s", inner.text);
	settings_describe_values(row, values, sizeof(values));
	return error_set(error, -EINVAL, "%.300s; it may be %s", inner.text, values);
}

/* "NAME". */
static int unset_one(struct wish *wish, char *text, struct error *error)
{
	const struct option_row *row = option_find(text);
	if (!row)
		return error_set(error, -EINVAL, "%.64s: there is no such setting", text);
	const int result = check_right(row, wish->owner, error);
	if (result == 0 && !wish->is_asked[row - option_table()])
		return error_set(error, -EINVAL, "%s was not asked for, so there is nothing to take back", row->name);
	wish->is_asked[row - option_table()] = false;
	return result;
}

static int change(struct live *live, const char *text, bool owner,
				  int (*one)(struct wish *wish, char *text, struct error *error), struct error *error)
{
	struct wish wish = {.asked = live->asked, .owner = owner};
	char words[1024], *rest = words;
	int result = 0;
	memcpy(wish.is_asked, live->is_asked, sizeof(wish.is_asked));
	if (strlen(text) >= sizeof(words))
		return error_set(error, -EINVAL, "longer than %zu bytes", sizeof(words) - 1);
	memcpy(words, text, strlen(text) + 1);
	char *word = strtok_r(rest, " ", &rest);
	if (!word)
		return error_set(error, -EINVAL, one == set_one ? "set: what? NAME=VALUE" : "unset: what? NAME");
	for (; word && result == 0; word = strtok_r(NULL, " ", &rest))
		result = one(&wish, word, error);
	if (result < 0)
		return result;
	live->asked = wish.asked;
	memcpy(live->is_asked, wish.is_asked, sizeof(live->is_asked));
	settle_and_tell(live);
	return 0;
}

int live_set(struct live *live, const char *text, bool owner, struct error *error)
{
	return change(live, text, owner, set_one, error);
}

int live_unset(struct live *live, const char *text, bool owner, struct error *error)
{
	return change(live, text, owner, unset_one, error);
}
