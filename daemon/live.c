/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/live.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/printable.h"
#include "daemon/setting_check.h"

enum live_effect live_effect_of(const struct option_row *row)
{
	static const char *const mains[] = {
		"max-clients", "max-frame-mb", "max-streams", "max-client-mb", "max-messages", "log-level",
	};
	if (option_is_of_picture(row) || strcmp(row->name, "on-client-exit") == 0)
		return LIVE_NEXT_FRAME;
	if (strcmp(row->name, "seccomp") == 0)
		return LIVE_ONE_WAY;
	for (size_t i = 0; i < sizeof(mains) / sizeof(mains[0]); i++)
		if (strcmp(mains[i], row->name) == 0)
			return LIVE_AT_ONCE;
	return LIVE_TAKEN_OVER;
}

const char *live_effect_name(enum live_effect effect)
{
	static const char *const names[] = {"at once", "with the next real frame", "taken over without a pause",
										"taken over, but not switched off again"};
	return names[effect];
}

static bool has_owner(const struct option_row *row)
{
	return live_effect_of(row) >= LIVE_TAKEN_OVER;
}

/* ---- life ---- */

void live_init(struct live *live, struct settings *settings, struct profiles *profiles, struct log *log)
{
	*live = (struct live){.settings = settings, .log = log, .base = *settings, .profiles = *profiles};
	live->asked = *settings;
	*profiles = (struct profiles){.list = NULL};
}

void live_finish(struct live *live)
{
	profiles_finish(&live->profiles);
}

void live_add_owner(struct live *live, const struct live_owner *owner)
{
	if (live->owner_count < LIVE_OWNERS)
		live->owners[live->owner_count++] = *owner;
}

const struct profile *live_profile(const struct live *live)
{
	return *live->application ? profiles_find(&live->profiles, live->application) : NULL;
}

/* ---- origins ---- */

/* What an empty path of the socket is made of. */
static const char *variable_of_socket(void)
{
	const char *path = getenv("PURSUIT_SOCKET"), *folder = getenv("XDG_RUNTIME_DIR");
	if (path && *path)
		return "PURSUIT_SOCKET";
	return folder && *folder ? "XDG_RUNTIME_DIR" : NULL;
}

static json_t *file_json(const char *path, unsigned line)
{
	char clean[PATH_MAX];
	char *real = realpath(path, NULL);
	snprintf(clean, sizeof(clean), "%s", real ? real : path);
	free(real);
	printable_clean(clean);
	return json_pack("{s:s, s:s, s:i}", "from", "configuration", "file", clean, "line", (int)line);
}

json_t *live_origin_json(const struct live *live, const struct option_row *row)
{
	const size_t place = (size_t)(row - option_table());
	const struct origin *origin = &live->origins[place];
	const struct profile *profile = live_profile(live);
	const char *variable = variable_of_socket();
	if (live->is_asked[place])
		return json_pack("{s:s}", "from", "set");
	if (profile && profile->has[place]) {
		char clean[EXECUTABLE_NAME_BYTES];
		snprintf(clean, sizeof(clean), "%s", profile->application);
		printable_clean(clean);
		return json_pack("{s:s, s:s}", "from", "profile", "application", clean);
	}
	if (origin->kind == ORIGIN_FILE)
		return file_json(origin->file, origin->line);
	if (origin->kind == ORIGIN_DEFAULT && strcmp(row->name, "socket") == 0 && variable)
		return json_pack("{s:s, s:s}", "from", "environment", "variable", variable);
	return json_pack("{s:s}", "from", origin->kind == ORIGIN_DEFAULT ? "default" : "command line");
}

/* ---- changes ---- */

/* Where the setting comes from now. */
static const struct settings *source_of(const struct live *live, const struct option_row *row)
{
	const size_t place = (size_t)(row - option_table());
	const struct profile *profile = live_profile(live);
	if (live->is_asked[place])
		return &live->asked;
	return profile && profile->has[place] ? &profile->values : &live->base;
}

/* What the settings are to be. */
static void compute(const struct live *live, struct settings *fresh)
{
	*fresh = *live->settings;
	for (const struct option_row *row = option_table(); row->name; row++)
		settings_copy(fresh, source_of(live, row), row);
}

static unsigned count_changes(const struct settings *a, const struct settings *b, bool (*of)(const struct option_row *))
{
	unsigned count = 0;
	for (const struct option_row *row = option_table(); row->name; row++)
		count += (!of || of(row)) && !settings_agree(a, b, row);
	return count;
}

static bool is_of_frames(const struct option_row *row)
{
	return live_effect_of(row) == LIVE_NEXT_FRAME;
}

static void tell_changes(const struct live *live, const struct settings *fresh)
{
	for (const struct option_row *row = option_table(); row->name; row++) {
		char before[OPTION_VALUE_BYTES], after[OPTION_VALUE_BYTES];
		if (settings_agree(live->settings, fresh, row))
			continue;
		settings_get(live->settings, row->name, before, sizeof(before));
		settings_get(fresh, row->name, after, sizeof(after));
		log_info(live->log, "%s is %s now, was %s", row->name, *after ? after : "empty", *before ? before : "empty");
	}
}

/* ---- owners ---- */

/* Of all, or of none of them. */
static int prepare(struct live *live, const struct settings *fresh, struct error *error)
{
	for (unsigned i = 0; i < live->owner_count; i++) {
		const struct live_owner *owner = &live->owners[i];
		const int result = owner->prepare(owner->data, live->settings, fresh, error);
		if (result == 0)
			continue;
		while (i-- > 0)
			live->owners[i].abandon(live->owners[i].data);
		return result;
	}
	return 0;
}

static void commit(struct live *live, const struct settings *fresh)
{
	for (unsigned i = 0; i < live->owner_count; i++)
		live->owners[i].commit(live->owners[i].data, fresh);
}

/* The settings in force are to be `fresh`. Gives how many changed, or a negative errno with a sentence: then none did.
 */
static int take_over(struct live *live, const struct settings *fresh, struct error *error)
{
	const unsigned changed = count_changes(live->settings, fresh, NULL);
	const bool owned = count_changes(live->settings, fresh, has_owner) > 0;
	const bool of_frames = count_changes(live->settings, fresh, is_of_frames) > 0;
	const int result = owned ? prepare(live, fresh, error) : 0;
	if (result < 0)
		return result;
	tell_changes(live, fresh);
	*live->settings = *fresh;
	if (live->log)
		log_set_level(live->log, (enum log_level)fresh->log_level);
	if (owned)
		commit(live, fresh);
	if (of_frames && live->output)
		output_set_settings(live->output, live->settings);
	return (int)changed;
}

static int settle(struct live *live, struct error *error)
{
	struct settings fresh;
	compute(live, &fresh);
	return take_over(live, &fresh, error);
}

/* ---- the configuration ---- */

static void tell_of_asked(const struct live *live, const struct settings *fresh)
{
	for (const struct option_row *row = option_table(); row->name; row++) {
		char before[OPTION_VALUE_BYTES], after[OPTION_VALUE_BYTES];
		if (!live->is_asked[row - option_table()] || settings_agree(&live->base, fresh, row))
			continue;
		settings_get(live->settings, row->name, before, sizeof(before));
		settings_get(fresh, row->name, after, sizeof(after));
		log_info(live->log, "%s is %s now in the configuration; it stays %s, as `pursuit set` asked for", row->name,
				 after, before);
	}
}

/* Those that have an owner, or those that have none. */
static void take_rows(struct live *live, const struct settings *from, const struct origin *origins, bool owned)
{
	for (const struct option_row *row = option_table(); row->name; row++) {
		if (has_owner(row) != owned)
			continue;
		settings_copy(&live->base, from, row);
		live->origins[row - option_table()] = origins[row - option_table()];
	}
}

unsigned live_reload(struct live *live, struct arguments *fresh, struct error *mistake)
{
	const struct settings before = live->base;
	struct origin origins[OPTION_ROWS];
	memcpy(origins, live->origins, sizeof(origins));
	mistake->text[0] = 0;
	tell_of_asked(live, &fresh->settings);
	profiles_finish(&live->profiles);
	live->profiles = fresh->profiles;
	fresh->profiles = (struct profiles){.list = NULL};
	take_rows(live, &fresh->settings, fresh->origins, false);
	take_rows(live, &fresh->settings, fresh->origins, true);
	int changed = settle(live, mistake);
	if (changed >= 0)
		return (unsigned)changed;
	origins_tell(live->origins, mistake);
	log_error(live->log, "%s; what else needs something new stays as it is, too", mistake->text);
	take_rows(live, &before, origins, true);
	struct error error;
	changed = settle(live, &error);
	return changed < 0 ? 0 : (unsigned)changed;
}

const struct settings *live_show(void *data, const char *application)
{
	struct live *live = data;
	struct settings fresh;
	if (strcmp(live->application, application) == 0)
		return NULL;
	snprintf(live->application, sizeof(live->application), "%s", application);
	if (live_profile(live))
		log_info(live->log, "settings of application %s", application);
	compute(live, &fresh);
	/* A profile holds settings of the picture only; the output takes them together with the stream. */
	const bool changed = count_changes(live->settings, &fresh, is_of_frames) > 0;
	tell_changes(live, &fresh);
	*live->settings = fresh;
	return changed ? live->settings : NULL;
}

/* ---- requests ---- */

static int check_right(const struct option_row *row, bool owner, struct error *error)
{
	if (!owner && live_effect_of(row) != LIVE_NEXT_FRAME)
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
	if (!row || row->type == OPTION_TEXT || row->choices)
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

static int take_wish(struct live *live, const struct wish *wish, struct error *error)
{
	const struct settings asked = live->asked;
	bool is_asked[OPTION_ROWS];
	memcpy(is_asked, live->is_asked, sizeof(is_asked));
	live->asked = wish->asked;
	memcpy(live->is_asked, wish->is_asked, sizeof(is_asked));
	const int result = settle(live, error);
	if (result >= 0)
		return 0;
	live->asked = asked;
	memcpy(live->is_asked, is_asked, sizeof(is_asked));
	return result;
}

/* The next one, in place, without the backslashes that make what follows a part of it; NULL at the end. */
static char *next_word(char **rest)
{
	char *from = *rest + strspn(*rest, " "), *word = from, *to = from;
	if (!*from)
		return NULL;
	while (*from && *from != ' ') {
		from += *from == '\\' && from[1];
		*to++ = *from++;
	}
	*rest = from + (*from == ' ');
	*to = 0;
	return word;
}

static int change(struct live *live, const char *text, bool owner,
				  int (*one)(struct wish *wish, char *text, struct error *error), struct error *error)
{
	struct wish wish = {.asked = live->asked, .owner = owner};
	char *words = strdup(text), *rest = words;
	int result = 0;
	if (!words)
		return error_set(error, -ENOMEM, "out of memory");
	memcpy(wish.is_asked, live->is_asked, sizeof(wish.is_asked));
	char *word = next_word(&rest);
	if (!word)
		result = error_set(error, -EINVAL, one == set_one ? "set: what? NAME=VALUE" : "unset: what? NAME");
	for (; word && result == 0; word = next_word(&rest))
		result = one(&wish, word, error);
	free(words);
	return result < 0 ? result : take_wish(live, &wish, error);
}

int live_set(struct live *live, const char *text, bool owner, struct error *error)
{
	return change(live, text, owner, set_one, error);
}

int live_unset(struct live *live, const char *text, bool owner, struct error *error)
{
	return change(live, text, owner, unset_one, error);
}
