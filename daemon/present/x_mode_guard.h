/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A process that puts a monitor's mode back when the daemon could not: it was killed, it crashed, or the X server hung
 * when it ended. It is the daemon's own program with an argument that nobody else gives, and sleeps until then.
 */
#ifndef PURSUIT_X_MODE_GUARD_H
#define PURSUIT_X_MODE_GUARD_H

#include <stdbool.h>
#include <sys/types.h>

/* What is to be put back, as RandR numbers things: at this server, if this part of it is in mode `now`. */
struct x_mode_guard_task {
	const char *display;
	unsigned long crtc, before, now;
};

/* Zeroed: none. */
struct x_mode_guard {
	pid_t pid;
	int fd; /* the daemon's end of a pipe */
};

/* Any thread. Where no program may be started (--seccomp) there is none: no matter then. */
void x_mode_guard_start(struct x_mode_guard *guard, const struct x_mode_guard_task *task);
/* All was left in good order. Zeroes it. */
void x_mode_guard_dismiss(struct x_mode_guard *guard);
/* It was not, and the daemon goes on: it is put back now, where there is a server still. May hang as that does. */
void x_mode_guard_call(struct x_mode_guard *guard);

/* First of all in main(): is it that process? Then it was, and main gives *status back. */
bool x_mode_guard_run(int argc, char **argv, int *status);

#endif
