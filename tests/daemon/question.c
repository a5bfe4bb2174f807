/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/daemon/question.h"

#include <errno.h>
#include <string.h>

#include "tests/daemon/fixture.h"
#include "tests/daemon/raw-client.h"

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

int question_set_at_last(int connection, const char *request)
{
	static _Thread_local struct raw_reply reply;
	int result = raw_control(connection, request, -1, &reply);
	for (unsigned waited = 0; waited < PATIENCE_MS && result == ENODEV; waited += 100) {
		sleep_ms(100);
		result = raw_control(connection, request, -1, &reply);
	}
	return result;
}

/* A second without a vblank, and without a look that came late: what was held up then may show something still. */
void question_wait_for_rest(int connection)
{
	json_int_t before = -1;
	const uint64_t end_ns = now_ns() + PATIENCE_MS * UINT64_C(1000000);
	uint64_t since_ns = now_ns(), looked_ns = since_ns;
	while (now_ns() - since_ns < UINT64_C(1000000000) && now_ns() < end_ns) {
		const json_int_t now = question_figure(connection, "timeline 0 0", "total");
		if (now != before || now_ns() - looked_ns > UINT64_C(150000000))
			since_ns = now_ns();
		before = now;
		looked_ns = now_ns();
		sleep_ms(50);
	}
	CHECK(now_ns() - since_ns >= UINT64_C(1000000000));
}

bool question_setting(int connection, const char *text)
{
	return strstr(ask(connection, "settings"), text) != NULL;
}
