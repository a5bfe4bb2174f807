/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "report_progress.h"
#include "daemon/clock.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define BAR 24u
#define LINE_S 10.0

static double now_s(void)
{
	return (double)clock_monotonic_ns() / 1e9;
}

void report_progress_begin(struct report_progress *progress, uint32_t total)
{
	*progress = (struct report_progress){.total = total ? total : 1, .terminal = isatty(STDERR_FILENO)};
	progress->started = now_s();
	progress->last = progress->started - LINE_S;
}

void report_progress_step(struct report_progress *progress, const char *format, ...)
{
	char text[160], bar[BAR + 1];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof(text), format, arguments);
	va_end(arguments);
	const double now = now_s(), passed = now - progress->started;
	const uint32_t done = progress->done < progress->total ? progress->done : progress->total;
	progress->done++;
	if (!progress->terminal && now - progress->last < LINE_S)
		return;
	progress->last = now;
	const unsigned percent = 100 * done / progress->total;
	const double left = done ? passed / done * (progress->total - done) : 0.0;
	if (!progress->terminal) {
		fprintf(stderr, "%3u %% after %.0f s: %s\n", percent, passed, text);
		return;
	}
	memset(bar, '.', BAR);
	memset(bar, '#', BAR * done / progress->total);
	bar[BAR] = '\0';
	fprintf(stderr, "\r[%s] %3u %%, %.0f s left  %-60.60s", bar, percent, left, text);
	fflush(stderr);
}

void report_progress_end(struct report_progress *progress)
{
	if (progress->terminal)
		fprintf(stderr, "\r%110s\r", "");
}
