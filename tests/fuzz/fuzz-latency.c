/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A latency log from anywhere, of either form. Input: a byte of choices, then
 * the file; one choice is to make the blocks' checksums right.
 */
#include <stdlib.h>
#include <string.h>

#include "daemon/lab/latency_format.h"
#include "daemon/lab/latency_read.h"
#include "daemon/lab/spans.h"
#include "tests/fuzz/fuzz.h"

static void seal(uint8_t *file, size_t size)
{
	for (size_t at = 0; at + LATENCY_BLOCK_HEAD <= size; at++) {
		if (memcmp(file + at, LATENCY_BLOCK_MAGIC, 4) != 0)
			continue;
		const uint64_t bytes = (uint64_t)latency_get_u32(file + at + 4) * LATENCY_ROW_BYTES;
		if (bytes <= size - at - LATENCY_BLOCK_HEAD)
			latency_put_u64(file + at + 16, latency_checksum(file + at + LATENCY_BLOCK_HEAD, (size_t)bytes));
	}
}

/* Every row can be counted; what is printed of it can be read again. */
static void use(const struct latency_table *table, struct spans *spans)
{
	char line[LATENCY_LINE], value[32];
	struct points back;
	for (uint64_t i = 0; i < table->count; i++) {
		const struct points *row = &table->rows[i];
		spans_add(spans, row);
		FUZZ_EXPECT(latency_print_row(row, line) > 0 && strlen(line) < LATENCY_LINE - 1);
		if (row->show < POINTS_SHOWS && row->source < PRESENTER_TIME_SOURCES && latency_parse_row(line, &back))
			FUZZ_EXPECT(back.vblank == row->vblank && back.set_ns == row->set_ns);
	}
	latency_table_setting(table, "refresh", value, sizeof(value));
}

int fuzz_one(const uint8_t *data, size_t size)
{
	struct spans *spans = calloc(1, sizeof(*spans));
	struct latency_table table;
	struct error error = {""};
	struct fuzz_file file;
	uint8_t *copy = malloc(size ? size : 1);
	if (size == 0 || !spans || !copy) {
		free(spans);
		free(copy);
		return 0;
	}
	memcpy(copy, data + 1, size - 1);
	if (data[0] & 1)
		seal(copy, size - 1);
	fuzz_file_init(&file, copy, size - 1);
	if (latency_read(file.path, &table, &error) == 0) {
		use(&table, spans);
		latency_table_finish(&table);
	} else {
		FUZZ_EXPECT(error.text[0]);
	}
	fuzz_file_finish(&file);
	free(copy);
	free(spans);
	return 0;
}
