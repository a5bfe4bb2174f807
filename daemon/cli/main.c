/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* pursuit: the command. A table of verbs, each in a file of its own. */

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "args.h"
#include "client/pursuit.h"
#include "daemon/descriptors.h"
#include "verbs.h"

struct verb {
	const char *name;
	int (*run)(int argc, char **argv);
	const char *help;
	const char *related; /* verbs to read about next, with spaces between */
};

static const struct verb verbs[] = {
	{"demo", verb_demo, "run the daemon and a scene that feeds it, and report what was displayed",
	 "doctor report record"},
	{"record", verb_record, "write a built-in scene, or what a running daemon receives, into a recording",
	 "replay check-stream export"},
	{"replay", verb_replay, "play a recording headless and deterministically, score it, compare it",
	 "record report export"},
	{"report", verb_report, "error against run time: every method, every scene, as a page", "replay record"},
	{"import", verb_import, "make a recording from sequences of images", "export check-stream replay"},
	{"export", verb_export, "write the frames of a recording as images or video", "import record"},
	{"check-stream", verb_check_stream, "find what is wrong with the motion, depth or times of a stream",
	 "record doctor"},
	{"latency", verb_latency, "print, plot and compare the time points of displayed frames; measure a GPIO line",
	 "top doctor"},
	{"doctor", verb_doctor, "look at this machine: what works, what does not, what mends it", "status demo"},
	{"top", verb_top, "show live what a running daemon does", "status set latency"},
	{"get", verb_get, "print the settings of a running daemon", "set profile status"},
	{"set", verb_set, "change settings of a running daemon", "get profile top"},
	{"profile", verb_profile, "settings of one application, by the name of its executable", "set get status"},
	{"status", verb_status, "say what a running daemon does", "top get"},
	{NULL, NULL, NULL, NULL},
};

static void print_help(FILE *out)
{
	fprintf(out, "usage: pursuit VERB [arguments]\n\n"
				 "Pursuit turns 30 to 60 rendered frames a second into a steady 120 Hz picture.\n\nverbs\n");
	for (const struct verb *verb = verbs; verb->name; verb++)
		fprintf(out, "  %-12s  %s\n", verb->name, verb->help);
	fprintf(out, "\n`pursuit VERB --help` explains one, with examples. `pursuit --version` names the version.\n");
}

static int unknown_verb(const char *name)
{
	const char *nearest = NULL;
	unsigned least = 4;
	for (const struct verb *verb = verbs; verb->name; verb++) {
		unsigned distance = args_distance(name, verb->name);
		if (distance < least) {
			least = distance;
			nearest = verb->name;
		}
	}
	fprintf(stderr, "pursuit: there is no verb %s%s%s%s\nTry `pursuit --help`.\n", name,
			nearest ? "; did you mean " : "", nearest ? nearest : "", nearest ? "?" : "");
	return STATUS_USAGE;
}

/* What could not be printed is not done. `name`: of a verb, or NULL. */
static int printed(const char *name, int status)
{
	int result = fflush(stdout) == 0 ? 0 : errno;
	if (result == 0 && !ferror(stdout))
		return status;
	/* Whoever wrote it had the reason, and has forgotten it. */
	if (result == 0 && (putchar('\n') == EOF || fflush(stdout) != 0))
		result = errno;
	fprintf(stderr, "pursuit%s%s: standard output cannot be written%s%s\n", name ? " " : "", name ? name : "",
			result ? ": " : "", result ? strerror(result) : "");
	return status == STATUS_DONE ? STATUS_FAILED : status;
}

int main(int argc, char **argv)
{
	descriptors_fill();
	signal(SIGXFSZ, SIG_IGN); /* a limit on file sizes is an error like a full disk */
	if (argc < 2) {
		print_help(stderr);
		return STATUS_USAGE;
	}
	if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0) {
		print_help(stdout);
		return printed(NULL, STATUS_DONE);
	}
	if (strcmp(argv[1], "--version") == 0) {
		printf("pursuit %d.%d.%d\n", PURSUIT_VERSION_MAJOR, PURSUIT_VERSION_MINOR, PURSUIT_VERSION_PATCH);
		return printed(NULL, STATUS_DONE);
	}
	if (strcmp(argv[1], "--print-verbs") == 0) { /* for the programs that make man pages and shell completions */
		for (const struct verb *verb = verbs; verb->name; verb++)
			printf("%s\t%s\t%s\n", verb->name, verb->help, verb->related);
		return printed(NULL, STATUS_DONE);
	}
	for (const struct verb *verb = verbs; verb->name; verb++) {
		if (strcmp(verb->name, argv[1]) == 0)
			return printed(verb->name, verb->run(argc - 1, argv + 1));
	}
	return unknown_verb(argv[1]);
}
