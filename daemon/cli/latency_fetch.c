/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "latency_fetch.h"

#include <errno.h>
#include <inttypes.h>

#include "daemon/lab/latency_format.h"

/* The daemon's rows have the columns of the CSV form. */
static bool parse_json_row(const json_t *row, struct points *points)
{
	char line[LATENCY_LINE];
	size_t used = 0;
	for (size_t i = 0; i < json_array_size(row) && used < sizeof(line); i++) {
		const json_t *value = json_array_get(row, i);
		const char *comma = i ? "," : "";
		if (json_is_string(value))
			used += (size_t)snprintf(line + used, sizeof(line) - used, "%s%.32s", comma, json_string_value(value));
		else if (json_is_integer(value))
			used += (size_t)snprintf(line + used, sizeof(line) - used, "%s%" JSON_INTEGER_FORMAT, comma,
									 json_integer_value(value));
		else
			used += (size_t)snprintf(line + used, sizeof(line) - used, json_is_real(value) ? "%s%.4f" : "%s", comma,
									 json_real_value(value));
	}
	return used < sizeof(line) && latency_parse_row(line, points);
}

static int add_rows(struct latency_table *table, const json_t *rows, struct error *error)
{
	for (size_t i = 0; i < json_array_size(rows); i++) {
		struct points points;
		if (!parse_json_row(json_array_get(rows, i), &points))
			return error_set(error, -EPROTO, "the daemon's latency has a row that is none; is it of another version?");
		if (latency_table_add(table, &points, error) < 0)
			return -ENOMEM;
	}
	return 0;
}

int latency_fetch(struct control *control, uint64_t *from, struct latency_table *table, struct error *error)
{
	int result = 0;
	for (uint64_t total = *from + 1; *from < total && result == 0;) {
		char request[48];
		json_t *reply = NULL;
		snprintf(request, sizeof(request), "latency %" PRIu64, *from);
		result = control_ask(control, request, -1, &reply, error);
		if (result < 0)
			return result;
		const json_t *rows = json_object_get(reply, "rows");
		const uint64_t first = (uint64_t)json_integer_value(json_object_get(reply, "first"));
		total = json_array_size(rows) ? (uint64_t)json_integer_value(json_object_get(reply, "total")) : 0;
		if (total)
			*from = first + json_array_size(rows);
		result = add_rows(table, rows, error);
		json_decref(reply);
	}
	return result;
}
