/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What every program of the stability suite has to say: for each case the worst
 * error, where it was, and the bound that it must keep. Printed, and with
 * --json FILE written as
 *
 *   {"suite": "...", "context": "...", "cases": [{"case": "...", "worst": 0.1, "where": "...", "bound": 0.5, "kept":
 * true}]}
 */
#ifndef PURSUIT_STABILITY_TABLE_H
#define PURSUIT_STABILITY_TABLE_H

#include <stdbool.h>
#include <stdint.h>

#define TABLE_TEXT 160

struct table_row {
	char name[TABLE_TEXT], where[TABLE_TEXT];
	double worst, bound;
};

struct table {
	const char *suite, *context;
	struct table_row *rows;
	uint32_t count, capacity;
};

/* Both names stay the caller's. */
void table_init(struct table *table, const char *suite, const char *context);

/* One look at a case; of several with one name the worst stays. Not a number counts as infinite. */
void table_add(struct table *table, const char *name, double error, const char *where, double bound);

/* Prints, writes what --json asks for, frees. False if a bound was broken or the file cannot be written. */
bool table_finish(struct table *table, int argc, char **argv);

#endif
