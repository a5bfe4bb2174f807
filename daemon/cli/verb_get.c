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

/* ---- at length ---- */

/* "set by pursuit set", "configuration file /etc/pursuit/pursuitd.conf:12" */
static void print_origin(json_t *origin)
{
	const char *from = json_string_value(json_object_get(origin, "from"));
	if (!from)
		printf("unknown");
	else if (strcmp(from, "set") == 0)
		printf("set by pursuit set");
	else if (strcmp(from, "configuration") == 0)
		printf("configuration file %s:%d", json_string_value(json_object_get(origin, "file")),
			   (int)json_integer_value(json_object_get(origin, "line")));
	else if (strcmp(from, "profile") == 0)
		printf("profile of %s", json_string_value(json_object_get(origin, "application")));
	else if (strcmp(from, "environment") == 0)
		printf("environment, %s", json_string_value(json_object_get(origin, "variable")));
	else
		printf("%s", from);
}

/* As a configuration file with comments. */
static void print_long(json_t *settings, json_t *origins)
{
	const char *name;
	json_t *value;
	json_object_foreach(settings, name, value)
	{
		const struct option_row *row = option_find(name);
		json_t *origin = json_object_get(origins, name);
		const char *live = json_string_value(json_object_get(origin, "live"));
		char range[160] = "?";
		if (row)
			settings_describe_values(row, range, sizeof(range));
		printf("# from: ");
		print_origin(origin);
		printf("\n# %s; default %s; when set: %s\n%s = %s\n\n", range,
			   !row || *row->default_value ? row ? row->default_value : "?" : "empty", live ? live : "?", name,
			   json_string_value(value));
	}
}

static void add_range(json_t *object, const struct option_row *row)
{
	json_object_set_new(object, "default", json_string(row->default_value));
	json_object_set_new(object, "unit", json_string(row->unit));
	if (row->max > row->min) {
		json_object_set_new(object, "least", json_real(row->min));
		json_object_set_new(object, "most", json_real(row->max));
	}
	json_t *choices = row->choices ? json_array() : NULL;
	for (size_t i = 0; row->choices && row->choices[i]; i++)
		json_array_append_new(choices, json_string(row->choices[i]));
	if (choices)
		json_object_set_new(object, "choices", choices);
}

/* {name: {value, from, ..., live, default, unit, least, most, choices}} */
static json_t *long_json(json_t *settings, json_t *origins)
{
	json_t *all = json_object();
	const char *name;
	json_t *value;
	json_object_foreach(settings, name, value)
	{
		json_t *object = json_pack("{s:O}", "value", value);
		const struct option_row *row = option_find(name);
		json_object_update(object, json_object_get(origins, name));
		if (row)
			add_range(object, row);
		json_object_set_new(all, name, object);
	}
	return all;
}

int verb_get(int argc, char **argv)
{
	bool as_json = false, at_length = false;
	const char *socket = NULL, *names[NAMES] = {NULL};
	unsigned count = 0;
	const struct arg_row rows[] = {
		{"long", ARG_FLAG, &at_length, 0, 0, NULL, NULL,
		 "with where each value comes from, what it may be, its default, and when it takes effect if it is set"},
		{"json", ARG_FLAG, &as_json, 0, 0, NULL, NULL, "as one JSON object of texts, of objects with --long"},
		{"socket", ARG_TEXT, &socket, 0, 0, NULL, "PATH", "of the daemon, where it is not the usual one"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "[NAME...] [--long] [--json]",
		.summary = "Prints the settings of the running daemon as they are now, one alone as its bare value. They have\n"
				   "the names of the options of pursuitd; `pursuit set` changes them. With --long each has comments\n"
				   "before it: whether its value is the default, or comes from a line of the configuration file, the\n"
				   "command line, the environment, the profile of an application, or `pursuit set`.",
		.examples = "  pursuit get\n"
					"  pursuit get method\n"
					"  pursuit get blur cell --json\n"
					"  pursuit get --long refresh present\n",
		.rows = rows,
		.positionals = names,
		.positional_max = NAMES,
		.positional_count = &count,
	};
	struct control control;
	struct error error = {{0}};
	json_t *all = NULL, *origins = NULL;
	int status;
	if (!args_parse(&args, argc, argv, &status))
		return status;
	if (control_open(&control, socket, &error) < 0)
		return args_failed(VERB, "%s", error.text);
	int result = control_ask_settings(&control, &all, &error);
	if (result == 0 && at_length)
		result = control_ask(&control, "origins", -1, &origins, &error);
	control_close(&control);
	if (result < 0) {
		json_decref(all);
		return args_failed(VERB, "%s", error.text);
	}
	json_t *chosen = choose(all, names, count);
	status = chosen ? STATUS_DONE : STATUS_USAGE;
	if (chosen && as_json)
		status = json_out(VERB, at_length ? long_json(chosen, origins) : json_incref(chosen));
	else if (chosen && at_length)
		print_long(chosen, origins);
	else if (chosen)
		print(chosen, count == 1);
	json_decref(chosen);
	json_decref(origins);
	json_decref(all);
	return status;
}
