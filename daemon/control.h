/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * CONTROL requests: what a client may ask the daemon. One line of text in, text
 * out; JSON where figures are told. On main.
 *
 *   status                  figures, streams, renderer (JSON)
 *   settings                the settings, name = value lines
 *   origins                 {name: {from, live, ...}}: where the value of each setting
 *                           comes from (live_origin_json()), and when it takes
 *                           effect if it is set (JSON)
 *   timeline [FROM [COUNT]] displayed frames: {first, total, rows: [[vblank,
 *                           target, ready, flip, frame id, show, phase], ...]};
 *                           ask again from first + number of rows
 *   latency [FROM [COUNT]]  settled rows of the lab, as lab_rows_json() has them;
 *                           refused where no option of the lab is set
 *   record                  with one fd, a regular file open for writing, which it
 *                           replaces: records the frames received from now on
 *   record-stop             ends the recording, and if it was that of the setting
 *                           `record` that is empty then, as if it had been set;
 *                           answered when it is on disk: {frames, dropped, bytes,
 *                           error}
 *   set NAME=VALUE ...      settings by name, all or none of them (live.h), with a
 *                           backslash before a space within a value; those of
 *                           the picture from the next real frame on; others only
 *                           for the daemon's own user and root (EPERM)
 *   unset NAME ...          takes back what was set: again as the configuration says
 *   reload                  reads the configuration again (reload.h); only for the
 *                           daemon's own user and root (EPERM)
 *   set focus=CLIENT        shows this client, by number or name (see status)
 *   key KEY                 as if it had been pressed in the window: one
 *                           character, or escape, f1, close; those that quit are for
 *                           the daemon's own user and root (EPERM)
 *   ping                    "pong"
 */
#ifndef PURSUIT_CONTROL_H
#define PURSUIT_CONTROL_H

#include <stdint.h>

#include "daemon/capture.h"
#include "daemon/clock.h"
#include "daemon/error.h"
#include "daemon/live.h"
#include "daemon/log.h"
#include "daemon/loop.h"
#include "daemon/options.h"
#include "daemon/output.h"
#include "daemon/reload.h"
#include "daemon/server.h"

struct control;

struct control_params {
	struct loop *loop;
	const struct log *log;
	struct clock *clock;
	const struct settings *settings;
	struct output *output;
	struct lab *lab; /* NULL: none */
	struct live *live;
	struct reload *reload;
	struct closer *closer; /* as capture_params says */
};

/* Starts the recording that the settings ask for. NULL with a sentence. */
struct control *control_create(const struct control_params *params, struct error *error);
/* Ends a recording, which waits for the disk. NULL accepted. */
void control_destroy(struct control **control);

/* What it records with. */
struct capture *control_get_capture(struct control *control);

/* Where answers go; before the first request. */
void control_set_server(struct control *control, struct server *server);

/* As server_params.control. */
void control_handle(void *data, uint64_t client_id, uint32_t serial, const char *text, int fd);

/* The status as JSON, for the end; the caller frees it. NULL: out of memory. */
char *control_status_text(struct control *control);

#endif
