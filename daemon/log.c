/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/log.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

void log_init(struct log *log, enum log_level level)
{
	log->fd = STDERR_FILENO;
	log->level = level;
	log->with_time = !getenv("JOURNAL_STREAM");
}

static size_t print_time(char *line, size_t size)
{
	struct timespec now;
	struct tm parts;
	clock_gettime(CLOCK_REALTIME, &now);
	localtime_r(&now.tv_sec, &parts);
	const size_t length = strftime(line, size, "%Y-%m-%dT%H:%M:%S", &parts);
	return length + (size_t)snprintf(line + length, size - length, ".%03ld ", now.tv_nsec / 1000000);
}

void log_set_level(struct log *log, enum log_level level)
{
	__atomic_store_n(&log->level, level, __ATOMIC_RELAXED);
}

void log_print(const struct log *log, enum log_level level, const char *format, ...)
{
	static const char *const names[] = {"error: ", "warning: ", "", "debug: "};
	const int saved = errno;
	char line[1024];
	size_t length = 0;
	va_list arguments;

	if (!log || level > __atomic_load_n(&log->level, __ATOMIC_RELAXED))
		return;
	if (log->with_time)
		length = print_time(line, sizeof(line));
	length += (size_t)snprintf(line + length, sizeof(line) - length, "pursuitd: %s", names[level]);
	va_start(arguments, format);
	const int added = vsnprintf(line + length, sizeof(line) - length, format, arguments);
	va_end(arguments);
	length += added > 0 ? (size_t)added : 0;
	if (length > sizeof(line) - 1)
		length = sizeof(line) - 1;
	for (size_t i = 0; i < length; i++)
		if ((unsigned char)line[i] < ' ' || line[i] == '\x7f')
			line[i] = '?';
	line[length] = '\n';
	/* Nothing can be done about a log that cannot be written. */
	if (write(log->fd, line, length + 1) < 0)
		errno = saved;
	errno = saved;
}

bool log_limit_allows(struct log_limit *limit, uint64_t now_ns)
{
	const uint64_t second = now_ns / UINT64_C(1000000000);
	if (second != limit->second) {
		limit->second = second;
		limit->count = 0;
	}
	if (limit->count >= LOG_LIMIT_PER_SECOND) {
		limit->suppressed++;
		return false;
	}
	limit->count++;
	return true;
}
