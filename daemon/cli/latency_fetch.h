/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The rows of a running daemon's lab, as a table like that of a log. */
#ifndef PURSUIT_CLI_LATENCY_FETCH_H
#define PURSUIT_CLI_LATENCY_FETCH_H

#include "control.h"
#include "daemon/lab/latency_read.h"

/*
 * Adds all rows from number *from on that the daemon still has (half a minute
 * at 120 Hz), and moves *from behind them. 0 or a negative errno with a
 * sentence; -EINVAL: the daemon has no lab.
 */
int latency_fetch(struct control *control, uint64_t *from, struct latency_table *table, struct error *error);

#endif
