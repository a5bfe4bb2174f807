/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/setting_check.h"

#include <errno.h>
#include <string.h>

#include "daemon/peer.h"
#include "daemon/present/presenter.h"

int setting_check(const struct option_row *row, const struct settings *settings, struct error *error)
{
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
