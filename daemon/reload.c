/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/reload.h"

#include <string.h>

/* Read by main alone, each time that they matter. */
static const char *const live[] = {
	"max-clients",  "max-frame-mb", "max-streams",  "max-client-mb",
	"max-messages", "allow-users",  "allow-groups", "log-level",
};

static bool is_live(const char *name)
{
	for (size_t i = 0; i < sizeof(live) / sizeof(live[0]); i++)
		if (strcmp(live[i], name) == 0)
			return true;
	return false;
}

unsigned reload_settings(struct settings *settings, const struct settings *fresh, struct log *log)
{
	unsigned changed = 0;
	for (const struct option_row *row = option_table(); row->name; row++) {
		char before[1024], after[1024];
		struct error error;
		settings_get(settings, row->name, before, sizeof(before));
		settings_get(fresh, row->name, after, sizeof(after));
		if (strcmp(before, after) == 0)
			continue;
		if (!is_live(row->name)) {
			log_warning(log, "%s is %s now; it stays %s until the daemon is restarted", row->name, after, before);
		} else if (settings_set(settings, row->name, after, &error) == 0) {
			log_info(log, "%s is %s now, was %s", row->name, *after ? after : "empty", *before ? before : "empty");
			changed++;
		}
	}
	log_set_level(log, (enum log_level)settings->log_level);
	return changed;
}
