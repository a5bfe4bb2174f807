/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A small process that outlives a crash: it sleeps until the daemon dies
 * without having said goodbye (a signal like SIGKILL or SIGSEGV included), then
 * requests the strobe's line itself and sets it low. The kernel frees the line
 * when the daemon dies, so between the two lies about a millisecond.
 */
#ifndef PURSUIT_LAB_GUARD_H
#define PURSUIT_LAB_GUARD_H

#include <sys/types.h>

#include "daemon/lab/chip.h"

/* Zeroed: none. */
struct guard {
	pid_t pid;
	int fd; /* the daemon's end of a pipe */
};

/*
 * Forks; at the start while there is one thread, which costs least. The params' strings need not live on. 0 or -errno
 * with a sentence.
 */
int guard_start(struct guard *guard, const struct chip_params *params, struct error *error);
/* The line was left in good order. */
void guard_dismiss(struct guard *guard);

#endif
