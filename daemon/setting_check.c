/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/setting_check.h"

#include <errno.h>
#include <string.h>

#include "daemon/peer.h"
#include "daemon/present/presenter.h"

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

int setting_check(const struct option_row *row, const struct settings *settings, struct error *error)
{
	if (strcmp(row->name, "method") == 0)
		return check_method(settings->method, error);
	if (strcmp(row->name, "present") == 0)
		return presenter_check_list(settings->present, error);
	if (strcmp(row->name, "allow-users") == 0)
		return peer_check_users(row->name, settings->allow_users, error);
	if (strcmp(row->name, "allow-groups") == 0)
		return peer_check_groups(row->name, settings->allow_groups, error);
	return 0;
}

int setting_check_all(const struct settings *settings, struct error *error)
{
	int result = 0;
	for (const struct option_row *row = option_table(); row->name && result == 0; row++)
		result = setting_check(row, settings, error);
	return result;
}
