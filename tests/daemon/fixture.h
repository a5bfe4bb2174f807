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

/* Longer than any machine keeps a process waiting: only what never comes takes so long. */
#define PATIENCE_MS 60000u

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
/* Both, again where a display server was too busy to answer; ends the test as skipped if there is no GL at all. */
void fixture_start(struct fixture *fixture, const char *const *arguments);

/* Signals and waits: the exit status, or 128 + signal, -1 if it had to be killed after PATIENCE_MS. */
int fixture_stop(struct fixture *fixture, int number);
/* Waits for it to end by itself. */
int fixture_join(struct fixture *fixture);

/* Does the log hold this text? Waits PATIENCE_MS for it. */
bool fixture_logged(const struct fixture *fixture, const char *text);
/* The same, for a text that comes again: how often it is there, and whether it is there so often at last. */
unsigned fixture_count_logged(const struct fixture *fixture, const char *text);
bool fixture_logged_often(const struct fixture *fixture, const char *text, unsigned times);
/* Open file descriptors of the daemon. */
int fixture_count_fds(const struct fixture *fixture);
/* The same once it has closed what others have: connections that have just ended may take a moment to go. */
int fixture_settled_fds(const struct fixture *fixture);
/* Are there so many at last? Waits PATIENCE_MS. */
bool fixture_fds_become(const struct fixture *fixture, int count);

uint64_t now_ns(void);
void sleep_ms(unsigned ms);

#endif
