/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The latency log's two forms with the same content (docs/lab.md).
 *
 * CSV: comment lines that begin with #, one line of column names, one line a
 * displayed frame. A time that is unknown is empty, one that was not yet known
 * when the row was written is "-".
 *
 * Binary, little-endian:
 *   "PURSLAT1", u32 bytes of text, the comment lines of the CSV form, then blocks:
 *   "PLBK", u32 rows, u64 rows dropped so far, u64 FNV-1a of the rows, the rows
 *   (LATENCY_ROW_BYTES each, in the order of struct points' fields below).
 * A file that ends within a block or line is good up to the one before.
 */
#ifndef PURSUIT_LAB_LATENCY_FORMAT_H
#define PURSUIT_LAB_LATENCY_FORMAT_H

#include <stddef.h>
#include <stdio.h>

#include "daemon/lab/points.h"
#include "daemon/present/presenter.h"

#define LATENCY_MAGIC "PURSLAT1"
#define LATENCY_BLOCK_MAGIC "PLBK"
#define LATENCY_BLOCK_HEAD 24u
#define LATENCY_BLOCK_ROWS 128u
#define LATENCY_ROW_BYTES 128u
#define LATENCY_LINE 640u

/* The comment lines that explain columns, units and clock; each begins with "# " and ends with a line feed. */
void latency_print_explanation(FILE *out);
/* "vblank,frame_id,...\n" */
const char *latency_column_line(void);

/* A CSV line with its line feed; gives its length back. */
size_t latency_print_row(const struct points *points, char line[LATENCY_LINE]);
/* False: no such line. */
bool latency_parse_row(const char *line, struct points *points);

void latency_pack_row(const struct points *points, uint8_t bytes[LATENCY_ROW_BYTES]);
void latency_unpack_row(const uint8_t bytes[LATENCY_ROW_BYTES], struct points *points);

uint64_t latency_checksum(const uint8_t *bytes, size_t size);
void latency_put_u32(uint8_t *bytes, uint32_t value);
void latency_put_u64(uint8_t *bytes, uint64_t value);
uint32_t latency_get_u32(const uint8_t *bytes);
uint64_t latency_get_u64(const uint8_t *bytes);

#endif
