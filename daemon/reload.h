/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Settings read again while the daemon runs: those that only main reads take
 * effect at once, no stream and no frame notices; of the others the log says
 * that they need a restart. On main.
 */
#ifndef PURSUIT_RELOAD_H
#define PURSUIT_RELOAD_H

#include "daemon/log.h"
#include "daemon/options.h"

/* Takes over what may change from `fresh`. Gives how many settings took effect. */
unsigned reload_settings(struct settings *settings, const struct settings *fresh, struct log *log);

#endif
