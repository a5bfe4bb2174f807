/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "args.h"
#include "control.h"
#include "json_out.h"
#include "verbs.h"

#define VERB "get"
#define NAMES 64u

/* Those that were asked for; all, if none was. NULL after a sentence: the daemon has no such one. */
static json_t *choose(json_t *all, const char *const *names, unsigned count)
{
	json_t *chosen = count ? json_object() : json_incref(all);
	for (unsigned i = 0; i < count; i++) {
		json_t *value = json_object_get(all, names[i]);
		const char *nearest = settings_nearest(names[i]);
		if (!value) {
			args_wrong(VERB, "%s: there is no such setting%s%s%s", names[i], nearest ? "; did you mean " : "",
					   nearest ? nearest : "", nearest ? "?" : "");
			json_decref(chosen);
			return NULL;
		}
		json_object_set(chosen, names[i], value);
	}
	return chosen;
}

static void print(json_t *settings, bool bare)
{
	const char *name;
	json_t *value;
	json_object_foreach(settings, name, value)
	{
		if (bare)
			printf("%s\n", json_string_value(value));
		else
			printf("%s = %s\n", name, json_string_value(value));
	}
}

int verb_get(int argc, char **argv)
{
	bool as_json = false;
	const char *socket = NULL, *names[NAMES] = {NULL};
	unsigned count = 0;
	const struct arg_row rows[] = {
		{"json", ARG_FLAG, &as_json, 0, 0, NULL, NULL, "as one JSON object of texts"},
		{"socket", ARG_TEXT, &socket, 0, 0, NULL, "PATH", "of the daemon, where it is not the usual one"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "[NAME...] [--json]",
		.summary = "Prints the settings of the running daemon as they are now, one alone as its bare value. They have\n"
				   "the names of the options of pursuitd; `pursuit set` changes them.",
		.examples = "  pursuit get\n"
					"  pursuit get method\n"
					"  pursuit get blur cell --json\n",
		.rows = rows,
		.positionals = names,
		.positional_max = NAMES,
		.positional_count = &count,
	};
	struct control control;
	struct error error = {{0}};
	json_t *all = NULL;
	int status;
	if (!args_parse(&args, argc, argv, &status))
		return status;
	if (control_open(&control, socket, &error) < 0)
		return args_failed(VERB, "%s", error.text);
	const int result = control_ask_settings(&control, &all, &error);
	control_close(&control);
	if (result < 0)
		return args_failed(VERB, "%s", error.text);
	json_t *chosen = choose(all, names, count);
	status = chosen ? STATUS_DONE : STATUS_USAGE;
	if (chosen && as_json)
		status = json_out(VERB, json_incref(chosen));
	else if (chosen)
		print(chosen, count == 1);
	json_decref(chosen);
	json_decref(all);
	return status;
}
