/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <jansson.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "args.h"
#include "control.h"
#include "json_out.h"
#include "verbs.h"

#define VERB "status"

/* Figures of the daemon that a person looks for first; everything is in --json. */
static void print_value(const char *name, const json_t *value)
{
	const char *key;
	json_t *inner;
	json_t *object = json_incref((json_t *)(uintptr_t)value);
	if (json_is_object(object)) {
		printf("  %-20s", name);
		const char *separator = " ";
		json_object_foreach(object, key, inner)
		{
			if (json_is_object(inner) || json_is_array(inner))
				continue;
			char *text = json_dumps(inner, JSON_ENCODE_ANY | JSON_REAL_PRECISION(4));
			printf("%s%s %s", separator, key, text ? text : "?");
			free(text);
			separator = ", ";
		}
		printf("\n");
	} else if (json_is_string(object)) {
		printf("  %-20s %s\n", name, json_string_value(object));
	} else if (!json_is_array(object)) {
		char *text = json_dumps(object, JSON_ENCODE_ANY | JSON_REAL_PRECISION(6));
		printf("  %-20s %s\n", name, text ? text : "?");
		free(text);
	}
	json_decref(object);
}

static void print_list(const char *name, const json_t *list)
{
	size_t index;
	json_t *item, *items = json_incref((json_t *)(uintptr_t)list);
	json_array_foreach(items, index, item)
	{
		const char *key;
		json_t *value;
		printf("%s %zu\n", name, index + 1);
		json_object_foreach(item, key, value) print_value(key, value);
	}
	json_decref(items);
}

static void print_status(json_t *status)
{
	const char *key;
	json_t *value;
	printf("pursuitd\n");
	json_object_foreach(status, key, value)
	{
		if (!json_is_array(value))
			print_value(key, value);
	}
	json_object_foreach(status, key, value)
	{
		if (json_is_array(value))
			print_list(key, value);
	}
}

int verb_status(int argc, char **argv)
{
	bool as_json = false;
	const char *socket = NULL;
	const struct arg_row rows[] = {
		{"json", ARG_FLAG, &as_json, 0, 0, NULL, NULL, "all of it as one JSON object"},
		{"socket", ARG_TEXT, &socket, 0, 0, NULL, "PATH", "of the daemon, where it is not the usual one"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "[--json]",
		.summary =
			"Says what the running daemon does: its streams, its output and its configuration, with their figures.",
		.examples = "  pursuit status\n"
					"  pursuit status --json | jq .displayed_hz\n",
		.rows = rows,
	};
	struct control control;
	struct error error = {{0}};
	json_t *reply = NULL;
	int status;
	if (!args_parse(&args, argc, argv, &status))
		return status;
	if (control_open(&control, socket, &error) < 0)
		return args_failed(VERB, "%s", error.text);
	int result = control_ask(&control, "status", -1, &reply, &error);
	control_close(&control);
	if (result < 0)
		return args_failed(VERB, "%s", error.text);
	if (as_json)
		return json_out(VERB, reply);
	print_status(reply);
	json_decref(reply);
	return STATUS_DONE;
}
