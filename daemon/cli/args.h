/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * One way to read arguments for all verbs: a table of the verb's own options,
 * the rows of options.h that it shares with the daemon, and positional ones.
 * Prints its own messages: "pursuit VERB: sentence" on stderr.
 */
#ifndef PURSUIT_CLI_ARGS_H
#define PURSUIT_CLI_ARGS_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon/options.h"

/* Exit statuses of every verb. */
#define STATUS_DONE 0
#define STATUS_FAILED 1
#define STATUS_USAGE 2

enum arg_type {
	ARG_FLAG,   /* bool */
	ARG_TEXT,   /* const char *, points into argv */
	ARG_NUMBER, /* uint32_t within min, max */
	ARG_REAL,   /* double within min, max */
	ARG_SIZE,   /* struct arg_size: 640x360 */
	ARG_RATE,   /* struct arg_rate: 60, 59.94, 60000/1001 */
	ARG_CHOICE, /* uint32_t index into choices */
};

struct arg_size {
	uint32_t width, height;
};

/* Hz = numerator / denominator. */
struct arg_rate {
	uint64_t numerator, denominator;
};

struct arg_row {
	const char *name; /* with dashes inside, without those in front */
	enum arg_type type;
	void *target;
	double min, max;
	const char *const *choices; /* NULL-terminated; of ARG_TEXT: words that completions offer */
	const char *value;          /* what help calls the value */
	const char *help;
};

struct args {
	const char *verb;
	const char *usage;   /* what follows the verb */
	const char *summary; /* a sentence or two */
	const char *examples;
	const char *status;         /* what exit status 1 means beside "failed"; may be NULL */
	const struct arg_row *rows; /* ended by a row without name; may be NULL */
	struct settings *settings;  /* with `groups`: rows of options.h taken too; may be NULL */
	unsigned groups;            /* 1 << OPTION_ENGINE, ... */
	const char **positionals;   /* filled in order */
	unsigned positional_min, positional_max;
	unsigned *positional_count; /* may be NULL */
};

/* argv[0] is the verb. True: go on. False: stop with *status (0 after --help, 2 after a usage error). */
bool args_parse(const struct args *args, int argc, char **argv, int *status);

/* A usage error found later: prints the sentence and where help is. Gives STATUS_USAGE back. */
__attribute__((format(printf, 2, 3))) int args_wrong(const char *verb, const char *format, ...);

/* "pursuit VERB: sentence" on stderr. Gives STATUS_FAILED back. */
__attribute__((format(printf, 2, 3))) int args_failed(const char *verb, const char *format, ...);

/* STATUS_DONE, or a usage error about this option, "--method", that lists the methods of the engine. */
int args_check_method(const char *verb, const char *option, const char *method);

bool args_read_rate(const char *text, struct arg_rate *rate);

/* How many letters to change, add or leave out to get from a to b; for "did you mean". */
unsigned args_distance(const char *a, const char *b);

#endif
