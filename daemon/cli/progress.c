/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "progress.h"
#include "daemon/clock.h"

#include <inttypes.h>
#include <stdio.h>
#include <unistd.h>

void progress_show(struct progress *progress, uint64_t done, uint64_t total)
{
	const uint64_t ms = clock_monotonic_ns() / 1000000;
	if (ms - progress->last_ms < 100 || !isatty(STDERR_FILENO))
		return;
	progress->last_ms = ms;
	progress->shown = true;
	fprintf(stderr, "\r%" PRIu64 " of %" PRIu64 " %s ", done, total, progress->what);
	fflush(stderr);
}

void progress_end(struct progress *progress)
{
	if (progress->shown)
		fprintf(stderr, "\r%40s\r", "");
	progress->shown = false;
}
