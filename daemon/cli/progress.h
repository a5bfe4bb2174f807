/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* One line on stderr that says how far a long work is; nothing where stderr is no terminal. */
#ifndef PURSUIT_CLI_PROGRESS_H
#define PURSUIT_CLI_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct progress {
	const char *what; /* "frames" */
	bool shown;
	uint64_t last_ms;
};

/* At most ten times a second. */
void progress_show(struct progress *progress, uint64_t done, uint64_t total);
/* Takes the line away. */
void progress_end(struct progress *progress);

#endif
