/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What the output receives, into one file at a time: that of the setting
 * `record`, or one that a client gave. A file is closed on a thread of its own,
 * since the disk may be slow. On main.
 */
#ifndef PURSUIT_CAPTURE_H
#define PURSUIT_CAPTURE_H

#include <jansson.h>
#include <stdbool.h>

#include "daemon/clock.h"
#include "daemon/closer.h"
#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/loop.h"
#include "daemon/options.h"
#include "daemon/output.h"

struct capture;

struct capture_params {
	struct loop *loop;
	const struct log *log;
	struct clock *clock;
	const struct settings *settings; /* in force; lives as long */
	struct output *output;
	struct closer *closer; /* NULL: files of before are closed while all wait */
};

/* Starts with the file that the settings ask for. NULL with a sentence. */
struct capture *capture_create(const struct capture_params *params, struct error *error);
/* Waits for the disk. NULL accepted. */
void capture_destroy(struct capture **capture);

/* Into a regular file of a client's; the fd is taken in any case. 0, -EBUSY, or another negative errno with a sentence.
 */
int capture_begin(struct capture *capture, int fd, struct error *error);

/*
 * Ends it; once it is on disk `done` is told (never after capture_destroy()): {frames, dropped, bytes, error} as
 * text, and the recorder's result. 0, or a negative errno with a sentence: nothing was running, or no thread can be
 * had.
 */
int capture_end(struct capture *capture,
				void (*done)(void *data, uint64_t client_id, uint32_t serial, int result, const char *text), void *data,
				uint64_t client_id, uint32_t serial, struct error *error);

/* {frames, dropped, bytes, error} as it runs; NULL: it does not. */
json_t *capture_json(const struct capture *capture);

/* As struct live_owner (live.h) says, of the setting `record`; `capture` is a struct capture. */
int capture_prepare(void *capture, const struct settings *now, const struct settings *fresh, struct error *error);
void capture_commit(void *capture, const struct settings *fresh);
void capture_abandon(void *capture);

/* "name = value", one a line; the caller frees it. NULL: out of memory. */
char *capture_settings_text(const struct settings *settings, const char *equals);

#endif
