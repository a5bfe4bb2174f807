/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Reads a latency log of either form. Files are hostile: nothing in them is believed unchecked. One thread. */
#ifndef PURSUIT_LAB_LATENCY_READ_H
#define PURSUIT_LAB_LATENCY_READ_H

#include <stdio.h>

#include "daemon/error.h"
#include "daemon/lab/points.h"

struct latency_table {
	struct points *rows;
	uint64_t count, capacity;
	char *header;       /* the comment lines, with "# " */
	uint64_t dropped;   /* rows that the writer could not keep */
	uint64_t cut_bytes; /* at the end, that make no whole block or line: the writer died */
};

/* 0, or a negative errno with a sentence that names the line or block. */
int latency_read(const char *path, struct latency_table *table, struct error *error);
/* Adds a row: 0 or -ENOMEM. */
int latency_table_add(struct latency_table *table, const struct points *points, struct error *error);
/* Zeroed accepted. */
void latency_table_finish(struct latency_table *table);
/* The value of "# setting NAME = VALUE" in the header; false if it is not there. */
bool latency_table_setting(const struct latency_table *table, const char *name, char *value, size_t size);

#endif
