/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A pursuitd of one's own for a test: started in a folder of its own, stopped,
 * watched. The first argument of the test program is the path of pursuitd.
 */
#ifndef PURSUIT_TEST_FIXTURE_H
#define PURSUIT_TEST_FIXTURE_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "tests/test.h"

struct fixture {
	const char *program;
	char folder[64];
	char socket[96];
	char log[96]; /* standard error of the daemon */
	pid_t pid;    /* 0: not running */
};

/* Makes the folder. */
void fixture_init(struct fixture *fixture, const char *program);
/* Kills what runs and removes the folder; prints the daemon's log if a check has failed. */
void fixture_finish(struct fixture *fixture);

/* Runs pursuitd with `--method hold --socket ...` and these arguments (NULL-terminated, may be NULL). */
void fixture_spawn(struct fixture *fixture, const char *const *arguments);
/* Waits until it answers; if it exits instead, false. */
bool fixture_wait(struct fixture *fixture);
/* Both; ends the test as skipped if there is no GL at all. */
void fixture_start(struct fixture *fixture, const char *const *arguments);

/* Signals and waits: the exit status, or 128 + signal, -1 if it had to be killed after 20 s. */
int fixture_stop(struct fixture *fixture, int number);
/* Waits for it to end by itself. */
int fixture_join(struct fixture *fixture);

/* Does the log hold this text? Waits up to 10 s for it. */
bool fixture_logged(const struct fixture *fixture, const char *text);
/* Open file descriptors of the daemon. */
int fixture_count_fds(const struct fixture *fixture);
/* The fewest seen over half a second: connections that were just closed may take a moment to go. */
int fixture_fewest_fds(const struct fixture *fixture);

uint64_t now_ns(void);
void sleep_ms(unsigned ms);

#endif
