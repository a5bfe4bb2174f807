/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/daemon/question.h"

#include <string.h>

#include "tests/daemon/raw-client.h"
#include "tests/test.h"

/* Valid until the next one. */
static const char *ask(int connection, const char *request)
{
	static _Thread_local struct raw_reply reply;
	CHECK_INT(raw_control(connection, request, -1, &reply), 0);
	return (const char *)reply.raw + sizeof(reply.control);
}

json_t *question_ask(int connection, const char *request)
{
	return json_loads(ask(connection, request), 0, NULL);
}

json_int_t question_figure(int connection, const char *request, const char *path)
{
	json_t *answer = question_ask(connection, request);
	const json_t *value = answer;
	char names[64], *rest = names;
	snprintf(names, sizeof(names), "%s", path);
	for (char *name; (name = strsep(&rest, ".")) != NULL;)
		value = json_object_get(value, name);
	if (!json_is_integer(value) && !json_is_array(value))
		fprintf(stderr, "%s: there is no %s\n", request, path);
	CHECK(json_is_integer(value) || json_is_array(value));
	const json_int_t figure = json_is_array(value) ? (json_int_t)json_array_size(value) : json_integer_value(value);
	json_decref(answer);
	return figure;
}

bool question_setting(int connection, const char *text)
{
	return strstr(ask(connection, "settings"), text) != NULL;
}
