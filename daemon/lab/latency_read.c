/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/latency_read.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/lab/latency_format.h"

#define HEADER_MOST (1u << 20)

int latency_table_add(struct latency_table *table, const struct points *points, struct error *error)
{
	if (table->count == table->capacity) {
		const uint64_t capacity = table->capacity ? table->capacity * 2 : 4096;
		struct points *grown = realloc(table->rows, capacity * sizeof(*grown));
		if (!grown)
			return error_set(error, -ENOMEM, "out of memory after %llu rows", (unsigned long long)table->count);
		table->rows = grown;
		table->capacity = capacity;
	}
	table->rows[table->count++] = *points;
	return 0;
}

void latency_table_finish(struct latency_table *table)
{
	free(table->rows);
	free(table->header);
	*table = (struct latency_table){0};
}

bool latency_table_setting(const struct latency_table *table, const char *name, char *value, size_t size)
{
	char wanted[96];
	snprintf(wanted, sizeof(wanted), "# setting %s = ", name);
	const char *line = table->header ? strstr(table->header, wanted) : NULL;
	if (!line)
		return false;
	line += strlen(wanted);
	snprintf(value, size, "%.*s", (int)strcspn(line, "\n"), line);
	return true;
}

/* ---- CSV ---- */

static void note_dropped(struct latency_table *table, const char *line)
{
	unsigned long long dropped;
	if (sscanf(line, "# dropped: %llu rows", &dropped) == 1)
		table->dropped = dropped;
}

static int read_csv(FILE *file, const char *path, struct latency_table *table, FILE *header, struct error *error)
{
	char line[LATENCY_LINE];
	struct points points;
	bool columns = false;
	for (unsigned number = 1; fgets(line, sizeof(line), file); number++) {
		if (line[0] == '#') {
			note_dropped(table, line);
			if (!columns)
				fputs(line, header);
		} else if (!columns) {
			columns = strcmp(line, latency_column_line()) == 0;
			if (!columns)
				return error_set(error, -EINVAL, "%s:%u: is no latency log of version 1: no line of its columns", path,
								 number);
		} else if (!strchr(line, '\n') && feof(file)) {
			table->cut_bytes = strlen(line);
		} else if (!latency_parse_row(line, &points)) {
			return error_set(error, -EINVAL, "%s:%u: is no row of a latency log: %.40s", path, number, line);
		} else if (latency_table_add(table, &points, error) < 0) {
			return -ENOMEM;
		}
	}
	return columns ? 0 : error_set(error, -EINVAL, "%s: is no latency log: no line of columns", path);
}

/* ---- binary ---- */

/* One block into the table: 1, 0 at the end or where it is cut, negative out of memory. */
static int read_block(FILE *file, struct latency_table *table, struct error *error)
{
	uint8_t head[LATENCY_BLOCK_HEAD], rows[LATENCY_BLOCK_ROWS * LATENCY_ROW_BYTES];
	struct points points;
	const size_t got = fread(head, 1, sizeof(head), file);
	if (got < sizeof(head)) {
		table->cut_bytes = got;
		return 0;
	}
	const uint32_t count = latency_get_u32(head + 4);
	const size_t size = (size_t)count * LATENCY_ROW_BYTES;
	const bool sane = memcmp(head, LATENCY_BLOCK_MAGIC, 4) == 0 && count > 0 && count <= LATENCY_BLOCK_ROWS;
	const size_t body = sane ? fread(rows, 1, size, file) : 0;
	if (!sane || body < size || latency_checksum(rows, size) != latency_get_u64(head + 16)) {
		table->cut_bytes = sizeof(head) + body;
		return 0;
	}
	table->dropped = latency_get_u64(head + 8);
	for (uint32_t i = 0; i < count; i++) {
		latency_unpack_row(rows + (size_t)i * LATENCY_ROW_BYTES, &points);
		if (latency_table_add(table, &points, error) < 0)
			return -ENOMEM;
	}
	return 1;
}

static int read_binary(FILE *file, const char *path, struct latency_table *table, FILE *header, struct error *error)
{
	uint8_t length[4];
	int result;
	if (fread(length, 1, 4, file) < 4 || latency_get_u32(length) > HEADER_MOST)
		return error_set(error, -EINVAL, "%s: the header of this latency log is damaged", path);
	for (uint32_t left = latency_get_u32(length); left > 0; left--) {
		const int byte = fgetc(file);
		if (byte == EOF || byte == 0)
			return error_set(error, -EINVAL, "%s: the header of this latency log is cut", path);
		fputc(byte, header);
	}
	while ((result = read_block(file, table, error)) > 0)
		;
	return result;
}

int latency_read(const char *path, struct latency_table *table, struct error *error)
{
	char magic[8];
	size_t size = 0;
	int result;
	*table = (struct latency_table){0};
	FILE *file = fopen(path, "re");
	if (!file)
		return error_set(error, -errno, "%s: %s", path, strerror(errno));
	FILE *header = open_memstream(&table->header, &size);
	if (!header) {
		fclose(file);
		return error_set(error, -ENOMEM, "out of memory");
	}
	const bool binary = fread(magic, 1, 8, file) == 8 && memcmp(magic, LATENCY_MAGIC, 8) == 0;
	if (!binary)
		rewind(file);
	result = binary ? read_binary(file, path, table, header, error) : read_csv(file, path, table, header, error);
	if (result == 0 && ferror(file))
		result = error_set(error, -EIO, "%s: cannot be read to its end", path);
	fclose(header);
	fclose(file);
	if (result < 0)
		latency_table_finish(table);
	return result;
}
