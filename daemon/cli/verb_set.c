/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <stdio.h>
#include <string.h>

#include "args.h"
#include "control.h"
#include "verbs.h"

#define VERB "set"
#define CHANGES 32u

/* What the daemon is asked. False: it does not fit. */
static bool write_request(char *request, size_t size, const char *const *changes, unsigned count)
{
	size_t used = (size_t)snprintf(request, size, "set");
	for (unsigned i = 0; i < count && used < size; i++)
		used += (size_t)snprintf(request + used, size - used, " %s", changes[i]);
	return used < size;
}

int verb_set(int argc, char **argv)
{
	const char *socket = NULL, *changes[CHANGES] = {NULL};
	unsigned count = 0;
	char request[256];
	const struct arg_row rows[] = {
		{"socket", ARG_TEXT, &socket, 0, 0, NULL, "PATH", "of the daemon, where it is not the usual one"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "NAME=VALUE...",
		.summary =
			"Changes settings of the running daemon, all of those given or none of them; those of the picture from\n"
			"the next real frame on. Which client is shown changes with focus=CLIENT, alone. Settings that cannot\n"
			"change while the daemon runs are refused.",
		.examples = "  pursuit set method=grid\n"
					"  pursuit set blur=everywhere cell=16\n"
					"  pursuit set governor=off level=0\n"
					"  pursuit set focus='the game'\n",
		.rows = rows,
		.positionals = changes,
		.positional_min = 1,
		.positional_max = CHANGES,
		.positional_count = &count,
	};
	struct control control;
	struct error error = {{0}};
	int status;
	if (!args_parse(&args, argc, argv, &status))
		return status;
	for (unsigned i = 0; i < count; i++)
		if (!strchr(changes[i], '='))
			return args_wrong(VERB, "%s is not of the form NAME=VALUE", changes[i]);
	if (!write_request(request, sizeof(request), changes, count))
		return args_wrong(VERB, "more than %zu bytes of settings at once", sizeof(request) - sizeof("set "));
	if (control_open(&control, socket, &error) < 0)
		return args_failed(VERB, "%s", error.text);
	const int result = control_ask(&control, request, -1, NULL, &error);
	control_close(&control);
	return result < 0 ? args_failed(VERB, "%s", error.text) : STATUS_DONE;
}
