/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* How far a report is, on stderr: a bar on a terminal, elsewhere a line every ten seconds at most. */
#ifndef PURSUIT_CLI_REPORT_PROGRESS_H
#define PURSUIT_CLI_REPORT_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct report_progress {
	uint32_t done, total;
	double started, last; /* s */
	bool terminal;
};

void report_progress_begin(struct report_progress *progress, uint32_t total);
/* A step begins; the text says which. */
__attribute__((format(printf, 2, 3))) void report_progress_step(struct report_progress *progress, const char *format,
																...);
/* Takes the bar away. */
void report_progress_end(struct report_progress *progress);

#endif
