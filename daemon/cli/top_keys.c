/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "top_keys.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/options.h"

enum action {
	ACTION_CYCLE,  /* the next value of a setting */
	ACTION_FOCUS,  /* the next client is shown */
	ACTION_UNDO,   /* all that was set is taken back */
	ACTION_WINDOW, /* a key of the daemon's window */
};

static const struct {
	char key;
	enum action action;
	const char *name; /* of the setting, or the key of the window */
	const char *help;
} keys[] = {
	{'m', ACTION_CYCLE, "method", "method"},
	{'b', ACTION_CYCLE, "blur", "blur"},
	{'c', ACTION_CYCLE, "compensation", "boost"},
	{'n', ACTION_CYCLE, "motion-model", "motion"},
	{'g', ACTION_CYCLE, "governor", "governor"},
	{'l', ACTION_CYCLE, "level", "level"},
	{'u', ACTION_UNDO, "", "undo"},
	{'f', ACTION_FOCUS, "", "next client"},
	{'i', ACTION_WINDOW, "i", "overlay"},
	{'s', ACTION_WINDOW, "s", "split"},
};

#define KEYS (sizeof(keys) / sizeof(keys[0]))

void top_keys_describe(char *text, size_t size)
{
	size_t used = 0;
	text[0] = 0;
	for (size_t i = 0; i < KEYS && used < size; i++)
		used += (size_t)snprintf(text + used, size - used, "%s%c %s", i ? "  " : "", keys[i].key, keys[i].help);
}

/* ---- the next value ---- */

static const char *next_choice(const char *const *choices, const char *now)
{
	size_t i = 0;
	while (choices[i] && strcmp(choices[i], now) != 0)
		i++;
	return choices[i] && choices[i + 1] ? choices[i + 1] : choices[0];
}

static void next_value(const struct option_row *row, const char *now, char *next, size_t size)
{
	if (row->choices)
		snprintf(next, size, "%s", next_choice(row->choices, now));
	else if (row->type == OPTION_FLAG)
		snprintf(next, size, "%s", strcmp(now, "yes") == 0 ? "no" : "yes");
	else
		snprintf(next, size, "%ld",
				 strtol(now, NULL, 10) < (long)row->max ? strtol(now, NULL, 10) + 1 : (long)row->min);
}

/* ---- requests ---- */

static bool write_cycle(const json_t *status, const char *name, char *request, size_t size)
{
	const char *now = json_string_value(json_object_get(json_object_get(status, "settings"), name));
	const struct option_row *row = option_find(name);
	char next[64];
	if (!now || !row)
		return false;
	next_value(row, now, next, sizeof(next));
	snprintf(request, size, "set %s=%s", name, next);
	return true;
}

/* The stream after the one that is shown. */
static bool write_focus(const json_t *status, char *request, size_t size)
{
	const json_t *streams = json_object_get(status, "streams");
	const size_t count = json_array_size(streams);
	size_t shown = 0;
	for (size_t i = 0; i < count; i++)
		if (json_is_true(json_object_get(json_array_get(streams, i), "shown")))
			shown = i;
	if (count < 2)
		return false;
	const json_t *next = json_array_get(streams, (shown + 1) % count);
	snprintf(request, size, "set focus=%" JSON_INTEGER_FORMAT, json_integer_value(json_object_get(next, "client_id")));
	return true;
}

static bool write_undo(const json_t *status, char *request, size_t size)
{
	const json_t *asked = json_object_get(json_object_get(status, "configuration"), "asked");
	size_t used = (size_t)snprintf(request, size, "unset");
	for (size_t i = 0; i < json_array_size(asked) && used < size; i++)
		used += (size_t)snprintf(request + used, size - used, " %s", json_string_value(json_array_get(asked, i)));
	return json_array_size(asked) > 0 && used < size;
}

static bool write_request(const json_t *status, size_t at, char *request, size_t size)
{
	switch (keys[at].action) {
	case ACTION_CYCLE:
		return write_cycle(status, keys[at].name, request, size);
	case ACTION_FOCUS:
		return write_focus(status, request, size);
	case ACTION_UNDO:
		return write_undo(status, request, size);
	case ACTION_WINDOW:
		snprintf(request, size, "key %s", keys[at].name);
		return true;
	}
	return false;
}

bool top_keys_press(struct control *control, const json_t *status, char key, char *message, size_t size)
{
	struct error error;
	char request[256];
	size_t at = 0;
	message[0] = 0;
	while (at < KEYS && keys[at].key != key)
		at++;
	if (at == KEYS)
		return false;
	if (!write_request(status, at, request, sizeof(request))) {
		snprintf(message, size, "%s: there is nothing to change", keys[at].help);
		return false;
	}
	if (control_ask(control, request, -1, NULL, &error) < 0)
		snprintf(message, size, "%.200s", error.text);
	else
		snprintf(message, size, "done: %.200s", request);
	return true;
}
