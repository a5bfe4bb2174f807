/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Tables of other programs, for the page. Two forms are read: {title, columns,
 * rows}, or a list of such; and that of the stability tests, {suite, context,
 * cases: [{case, worst, where, bound, kept}]}.
 */

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"

static bool is_table(const json_t *table)
{
	return json_is_string(json_object_get(table, "title")) && json_is_array(json_object_get(table, "columns")) &&
		   json_is_array(json_object_get(table, "rows"));
}

static bool is_suite(const json_t *file)
{
	return json_is_string(json_object_get(file, "suite")) && json_is_array(json_object_get(file, "cases"));
}

/* A new table of a stability suite. */
static json_t *table_of_suite(const json_t *suite)
{
	char title[256];
	const char *context = json_string_value(json_object_get(suite, "context"));
	size_t i;
	json_t *one, *rows = json_array();
	json_array_foreach(json_object_get(suite, "cases"), i, one)
	{
		json_t *kept = json_object_get(one, "kept"), *row = json_array();
		json_array_append(row, json_object_get(one, "case"));
		json_array_append(row, json_object_get(one, "worst"));
		json_array_append(row, json_object_get(one, "bound"));
		json_array_append_new(row, json_string(json_is_true(kept) ? "kept" : "BROKEN"));
		json_array_append(row, json_object_get(one, "where"));
		json_array_append_new(rows, row);
	}
	snprintf(title, sizeof(title), "Stability: %.100s%s%.100s", json_string_value(json_object_get(suite, "suite")),
			 context && *context ? ", " : "", context ? context : "");
	return json_pack("{s:s, s:[s, s, s, s, s], s:o}", "title", title, "columns", "case", "worst error", "bound",
					 "kept?", "where", "rows", rows);
}

static int load_table(struct report *report, const char *path, struct error *error)
{
	json_error_t why;
	json_t *file = json_load_file(path, 0, &why);
	if (!file)
		return error_set(error, -EINVAL, "%s: %s", path, why.text);
	bool right = json_is_array(file) || is_table(file) || is_suite(file);
	for (size_t i = 0; i < json_array_size(file); i++)
		right &= is_table(json_array_get(file, i));
	if (right && json_is_array(file))
		json_array_extend(report->tables, file);
	else if (right && is_suite(file))
		json_array_append_new(report->tables, table_of_suite(file));
	else if (right)
		json_array_append(report->tables, file);
	json_decref(file);
	return right ? 0 : error_set(error, -EINVAL, "%s: a table needs title, columns and rows, or suite and cases", path);
}

int report_load_tables(struct report *report, struct error *error)
{
	int result = 0;
	char *list = report->options.tables ? strdup(report->options.tables) : NULL, *rest = NULL;
	report->tables = json_array();
	if (!report->tables)
		result = error_set(error, -ENOMEM, "out of memory");
	for (char *path = list ? strtok_r(list, ",", &rest) : NULL; path && result == 0; path = strtok_r(NULL, ",", &rest))
		result = load_table(report, path, error);
	free(list);
	return result;
}
