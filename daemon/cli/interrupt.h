/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Ctrl-C ends a long work early instead of the program: the first time; the second ends the program. */
#ifndef PURSUIT_CLI_INTERRUPT_H
#define PURSUIT_CLI_INTERRUPT_H

#include <stdbool.h>

/* Watches SIGINT, SIGTERM and SIGHUP from here on. */
void interrupt_watch(void);
bool interrupt_seen(void);

#endif
