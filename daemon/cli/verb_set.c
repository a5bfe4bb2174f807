/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "args.h"
#include "control.h"
#include "json_out.h"
#include "verbs.h"

#define VERB "set"
#define CHANGES 32u

/*
 * What the daemon is asked: words, in which spaces are escaped; a client's name is the rest as it is. To be freed;
 * NULL: out of memory.
 */
static char *write_request(const char *what, const char *const *changes, unsigned count)
{
	const bool whole = strncmp(changes[0], "focus=", 6) == 0;
	char *request = NULL;
	size_t size;
	FILE *out = open_memstream(&request, &size);
	if (!out)
		return NULL;
	fputs(what, out);
	for (unsigned i = 0; i < count; i++) {
		fputc(' ', out);
		for (const char *c = changes[i]; *c; c++)
			fprintf(out, "%s%c", !whole && (*c == ' ' || *c == '\\') ? "\\" : "", *c);
	}
	if (fclose(out) == 0)
		return request;
	free(request);
	return NULL;
}

/* The settings that were named, as they are now. focus is none of them. */
static int ask_settings(struct control *control, const char *const *changes, unsigned count, json_t **now,
						struct error *error)
{
	json_t *all = NULL;
	const int result = control_ask_settings(control, &all, error);
	*now = json_object();
	for (unsigned i = 0; i < count && result == 0; i++) {
		char name[64];
		snprintf(name, sizeof(name), "%.*s", (int)strcspn(changes[i], "="), changes[i]);
		if (json_object_get(all, name))
			json_object_set(*now, name, json_object_get(all, name));
	}
	json_decref(all);
	return result;
}

int verb_set(int argc, char **argv)
{
	bool as_json = false, undo = false;
	const char *socket = NULL, *changes[CHANGES] = {NULL};
	unsigned count = 0;
	const struct arg_row rows[] = {
		{"undo", ARG_FLAG, &undo, 0, 0, NULL, NULL,
		 "take back what was set: NAMEs alone; they are again as the configuration says"},
		{"json", ARG_FLAG, &as_json, 0, 0, NULL, NULL, "the changed settings as they are now, as one JSON object"},
		{"socket", ARG_TEXT, &socket, 0, 0, NULL, "PATH", "of the daemon, where it is not the usual one"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "NAME=VALUE... | --undo NAME...",
		.summary =
			"Changes settings of the running daemon, all of those given or none of them; those of the picture from\n"
			"the next real frame on. What others need (a window, a file, a socket) is made beside what there is and\n"
			"then takes over; if it cannot be made all stays as it was. Which client is shown changes with\n"
			"focus=CLIENT, alone. What is set goes before the configuration file and the profiles of applications,\n"
			"until it is taken back or the daemon ends.",
		.examples = "  pursuit set method=grid\n"
					"  pursuit set blur=everywhere cell=16\n"
					"  pursuit set governor=off level=0\n"
					"  pursuit set present=glfw,headless refresh=60\n"
					"  pursuit set --undo blur cell\n"
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
		if (!strchr(changes[i], '=') != undo)
			return args_wrong(
				VERB, undo ? "%s: to take a setting back its NAME is enough" : "%s is not of the form NAME=VALUE",
				changes[i]);
	if (control_open(&control, socket, &error) < 0)
		return args_failed(VERB, "%s", error.text);
	char *request = write_request(undo ? "unset" : "set", changes, count);
	json_t *now = NULL;
	int result =
		request ? control_ask(&control, request, -1, NULL, &error) : error_set(&error, -ENOMEM, "out of memory");
	free(request);
	if (result == 0 && as_json)
		result = ask_settings(&control, changes, count, &now, &error);
	control_close(&control);
	if (result < 0)
		return args_failed(VERB, "%s", error.text);
	return as_json ? json_out(VERB, now) : STATUS_DONE;
}
