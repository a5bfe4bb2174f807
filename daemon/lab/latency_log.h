/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Writes the latency log (latency_format.h) on a thread of its own, four times
 * a second, block by block, so that a crash costs the last quarter of a second.
 * What the disk is too slow for is dropped and counted, and the log says where.
 */
#ifndef PURSUIT_LAB_LATENCY_LOG_H
#define PURSUIT_LAB_LATENCY_LOG_H

#include "daemon/error.h"
#include "daemon/lab/points.h"
#include "daemon/log.h"

struct latency_log;

/* The form that a file's name asks for: 0, or -EINVAL with a sentence if it ends in neither .csv nor .bin. */
int latency_log_check(const char *path, struct error *error);

/* header: lines without #, for the top. NULL with a sentence. */
struct latency_log *latency_log_create(const char *path, const char *header, const struct log *log,
									   struct error *error);
/* Writes what is left. NULL accepted. */
void latency_log_destroy(struct latency_log **log);

/* One thread; never waits. NULL accepted. */
void latency_log_push(struct latency_log *log, const struct points *points);

/* Any thread. */
uint64_t latency_log_written(const struct latency_log *log);
uint64_t latency_log_dropped(const struct latency_log *log);

#endif
