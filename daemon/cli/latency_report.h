/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* What a latency log says: spans with percentiles, where its times come from, and how sure they are. */
#ifndef PURSUIT_CLI_LATENCY_REPORT_H
#define PURSUIT_CLI_LATENCY_REPORT_H

#include <jansson.h>

#include "daemon/lab/latency_read.h"
#include "daemon/lab/spans.h"
#include "daemon/present/presenter.h"

struct latency_report {
	const char *name; /* of the file, or "the daemon" */
	struct latency_table table;
	struct spans spans;
	uint64_t sources[PRESENTER_TIME_SOURCES]; /* rows whose flip is known so */
	uint64_t shows[POINTS_SHOWS];
	uint64_t late, skipped;
	double seconds; /* from the first flip to the last */
};

/* Counts table.rows, which stay. The report is large: on the heap. */
void latency_report_count(struct latency_report *report);
void latency_report_finish(struct latency_report *report);

/* For a person. */
void latency_report_print(const struct latency_report *report, FILE *out);
/* The difference of two, b - a, with the 95 % interval of the means. */
void latency_report_compare(const struct latency_report *a, const struct latency_report *b, FILE *out);

/* The caller's. */
json_t *latency_report_json(const struct latency_report *report);
json_t *latency_compare_json(const struct latency_report *a, const struct latency_report *b);

/* Histograms and time series; b may be NULL. 0 or a negative errno with a sentence. */
int latency_report_svg(const struct latency_report *a, const struct latency_report *b, const char *path,
					   struct error *error);

#endif
