/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Engines that are made while another one works: on a thread of their own, since drivers compile for long. */
#ifndef PURSUIT_ENGINE_MAKER_H
#define PURSUIT_ENGINE_MAKER_H

#include "daemon/error.h"
#include "daemon/log.h"
#include "daemon/options.h"

/*
 * Waits until it is there, at most ten seconds: a driver that hangs is left to itself; the service manager's watchdog
 * is fed meanwhile. The engine is anybody's, on whatever thread that one uses it. NULL with a sentence. On main.
 */
struct engine *engine_maker_make(const struct settings *settings, const struct log *log, struct error *error);

#endif
