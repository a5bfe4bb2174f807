/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The log: one line a message, one write a line, so that threads may share a
 * log without a lock. Control characters are replaced, since names and texts
 * come from clients.
 */
#ifndef PURSUIT_LOG_H
#define PURSUIT_LOG_H

#include <stdbool.h>
#include <stdint.h>

enum log_level {
	LOG_LEVEL_ERROR = 0,
	LOG_LEVEL_WARNING,
	LOG_LEVEL_INFO,
	LOG_LEVEL_DEBUG,
};

/* Never changes after log_init(), except `level`, by log_set_level(). */
struct log {
	int fd;
	enum log_level level;
	bool with_time; /* local time, ISO 8601, in front of each line */
};

/* To standard error; with times unless systemd's journal adds its own. */
void log_init(struct log *log, enum log_level level);

/* While other threads log. */
void log_set_level(struct log *log, enum log_level level);

/* Keeps errno. A NULL log is silent. */
__attribute__((format(printf, 3, 4))) void log_print(const struct log *log, enum log_level level, const char *format,
													 ...);

#define log_error(log, ...) log_print(log, LOG_LEVEL_ERROR, __VA_ARGS__)
#define log_warning(log, ...) log_print(log, LOG_LEVEL_WARNING, __VA_ARGS__)
#define log_info(log, ...) log_print(log, LOG_LEVEL_INFO, __VA_ARGS__)
#define log_debug(log, ...) log_print(log, LOG_LEVEL_DEBUG, __VA_ARGS__)

/* What others can cause is limited to so many messages a second. Zeroed is ready. One thread. */
#define LOG_LIMIT_PER_SECOND 4u

struct log_limit {
	uint64_t second;
	uint32_t count;
	uint32_t suppressed; /* since the last message that was let through */
};

bool log_limit_allows(struct log_limit *limit, uint64_t now_ns);

#endif
