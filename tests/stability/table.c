/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void table_init(struct table *table, const char *suite, const char *context)
{
	*table = (struct table){.suite = suite, .context = context};
}

static struct table_row *find_row(struct table *table, const char *name)
{
	for (uint32_t i = 0; i < table->count; i++)
		if (strcmp(table->rows[i].name, name) == 0)
			return &table->rows[i];
	if (table->count == table->capacity) {
		table->capacity = table->capacity ? 2 * table->capacity : 64;
		table->rows = realloc(table->rows, table->capacity * sizeof(*table->rows));
		if (!table->rows)
			abort();
	}
	struct table_row *row = &table->rows[table->count++];
	*row = (struct table_row){.worst = -1.0};
	snprintf(row->name, sizeof(row->name), "%s", name);
	return row;
}

void table_add(struct table *table, const char *name, double error, const char *where, double bound)
{
	struct table_row *row = find_row(table, name);
	const double worst = isnan(error) ? HUGE_VAL : error;
	row->bound = bound;
	if (worst <= row->worst)
		return;
	row->worst = worst;
	snprintf(row->where, sizeof(row->where), "%s", where);
}

static bool is_kept(const struct table_row *row)
{
	return row->worst <= row->bound;
}

static bool write_json(const struct table *table, const char *path)
{
	FILE *out = fopen(path, "w");
	if (!out) {
		perror(path);
		return false;
	}
	fprintf(out, "{\"suite\": \"%s\", \"context\": \"%s\", \"cases\": [", table->suite, table->context);
	for (uint32_t i = 0; i < table->count; i++) {
		const struct table_row *row = &table->rows[i];
		/* JSON knows no infinity. */
		fprintf(out, "%s\n{\"case\": \"%s\", \"worst\": %.9g, \"where\": \"%s\", \"bound\": %.9g, \"kept\": %s}",
				i ? "," : "", row->name, fmin(row->worst, 1e300), row->where, row->bound,
				is_kept(row) ? "true" : "false");
	}
	fprintf(out, "\n]}\n");
	return fclose(out) == 0;
}

bool table_finish(struct table *table, int argc, char **argv)
{
	bool good = true;
	for (uint32_t i = 0; i < table->count; i++) {
		const struct table_row *row = &table->rows[i];
		good &= is_kept(row);
		printf("%-6s %-70s worst %-11.5g bound %-9.4g %s\n", is_kept(row) ? "kept" : "BROKEN", row->name, row->worst,
			   row->bound, row->where);
	}
	for (int i = 1; i + 1 < argc; i++)
		if (strcmp(argv[i], "--json") == 0)
			good &= write_json(table, argv[i + 1]);
	free(table->rows);
	return good;
}
