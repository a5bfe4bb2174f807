/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What the service manager is told, and its watchdog. The protocol is a datagram
 * of `NAME=VALUE` lines (sd_notify(3)), stable by systemd's own promise and less
 * than a library to link: so it is spoken by hand.
 *
 * The watchdog is fed from the presentation loop: at each third of the interval
 * main looks whether the render thread has gone round since the last look, tells
 * systemd if so, and wakes it. An idle loop goes round because it is woken; a
 * stuck one does not, one whose presenter reports no vblanks does not count
 * (output_beats()), and the service is restarted. So it is if main does not come
 * to look, or has gone round its own loop more than WATCHDOG_ROUNDS times a
 * second for nothing. One step may last, on slow software GL with a huge picture
 * or while shaders are compiled: as long as threads beside main work meanwhile
 * (WATCHDOG_SHARE) it is no reason, but for WATCHDOG_LONGEST intervals at most,
 * since a thread may work for ever too.
 *
 * On main.
 */
#ifndef PURSUIT_NOTIFY_H
#define PURSUIT_NOTIFY_H

#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/loop.h"
#include "daemon/output.h"

/* Sends to $NOTIFY_SOCKET; nothing without one. Never waits. */
void notify_send(const struct log *log, const char *state);
void notify_ready(const struct log *log);
void notify_reloading(const struct log *log);
void notify_stopping(const struct log *log);

/* Rounds of main's loop a second beyond what there was to do (loop_get_work()); a mouse makes up to 8,000. */
#define WATCHDOG_ROUNDS 20000u
/* Of a CPU, at least, that a step that goes on uses; it may have to share one with many. */
#define WATCHDOG_SHARE 0.05
#define WATCHDOG_LONGEST 6u

struct watchdog;

/* *watchdog is NULL if the manager wants none ($WATCHDOG_USEC, $WATCHDOG_PID). 0 or -errno with a sentence. */
int watchdog_create(struct watchdog **watchdog, struct loop *loop, const struct log *log, struct output *output,
					struct error *error);
/* NULL accepted. */
void watchdog_destroy(struct watchdog **watchdog);

#endif
