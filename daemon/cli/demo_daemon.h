/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The daemon of the demo: a child with a socket of its own in a folder of its own, never left behind. */
#ifndef PURSUIT_CLI_DEMO_DAEMON_H
#define PURSUIT_CLI_DEMO_DAEMON_H

#include <stdbool.h>
#include <sys/types.h>

#include "control.h"
#include "daemon/error.h"

struct demo_daemon {
	pid_t pid; /* 0: none */
	char folder[64];
	char socket[104];
	const char *log; /* path; what the daemon says */
	struct control control;
};

/*
 * Finds pursuitd (beside this program, in the folder above it, where it was
 * installed, in PATH), starts it with these arguments (NULL-terminated, after
 * --socket) and waits until it answers. 0 or a negative errno with a sentence.
 */
int demo_daemon_start(struct demo_daemon *daemon, const char *const *arguments, const char *log, struct error *error);

/* Still there? */
bool demo_daemon_lives(struct demo_daemon *daemon);

/* Asks it to end, waits, kills it if it does not. 0, or -ECHILD with a sentence if it died before or ended badly. */
int demo_daemon_stop(struct demo_daemon *daemon, struct error *error);

#endif
