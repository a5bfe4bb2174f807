/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The daemon: reads settings, starts output and server, runs until a signal. */

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "daemon/clock.h"
#include "daemon/control.h"
#include "daemon/keyboard.h"
#include "daemon/lab/chip.h"
#include "daemon/lab/lab.h"
#include "daemon/live.h"
#include "daemon/log.h"
#include "daemon/loop.h"
#include "daemon/notify.h"
#include "daemon/options.h"
#include "daemon/output.h"
#include "daemon/present/presenter.h"
#include "daemon/seccomp.h"
#include "daemon/server.h"
#include "daemon/version.h"

#define ALL_GROUPS (1u << OPTION_ENGINE | 1u << OPTION_OUTPUT | 1u << OPTION_LAB | 1u << OPTION_DAEMON)
#define EXIT_USAGE 2
#define DAEMON_NICE (-3)

struct pursuitd {
	struct settings settings;
	struct log log;
	struct clock clock;
	struct loop *loop;
	struct lab *lab; /* NULL unless an option of the lab is set */
	struct output *output;
	struct live live;
	struct control *control;
	struct server *server;
	struct keyboard keyboard;
	struct watchdog *watchdog;
	int argc;
	char **argv;
};

/* ---- the command line ---- */

static int usage_error(const char *sentence)
{
	fprintf(stderr, "pursuitd: %s\nTry pursuitd --help.\n", sentence);
	return EXIT_USAGE;
}

static void print_help(void)
{
	printf("Usage: pursuitd [--config FILE] [OPTIONS]\n\n"
		   "Takes rendered frames from clients, makes the frames in between, and presents them.\n"
		   "Stays in the foreground; SIGINT and SIGTERM end it.\n\n"
		   "  %-30s %s\n  %-30s %s\n  %-30s %s\n  %-30s %s\n",
		   "--config FILE", "Read settings from FILE; options that follow go before them.", "--print-config",
		   "Print a configuration file with all defaults.", "--version", "Print the version.", "--help", "Print this.");
	settings_print_help(ALL_GROUPS, stdout);
	printf("\nMethods:\n");
	for (const struct engine_method_info *method = engine_methods(); method->name; method++)
		printf("  %-16s %s\n", method->name, method->description);
	printf("\nPresenters built in:\n");
	for (const struct presenter_impl *const *impl = presenter_impls(); *impl; impl++)
		if ((*impl)->create)
			printf("  %-16s %s\n", (*impl)->name, (*impl)->description);
}

/* "--config FILE" and "--config=FILE": 1 taken, 0 not it, -1 refused with a sentence. */
static int take_config(struct settings *settings, int argc, char **argv, int *index, struct error *error)
{
	const char *path;
	if (strncmp(argv[*index], "--config=", 9) == 0) {
		path = argv[*index] + 9;
	} else if (strcmp(argv[*index], "--config") == 0) {
		if (*index + 1 >= argc) {
			error_set(error, -EINVAL, "--config needs a file");
			return -1;
		}
		path = argv[++*index];
	} else {
		return 0;
	}
	return settings_load(settings, path, error) < 0 ? -1 : 1;
}

static int refuse_argument(const char *argument)
{
	char sentence[256], name[64];
	const char *nearest = NULL;
	if (strncmp(argument, "--", 2) == 0) {
		snprintf(name, sizeof(name), "%.*s", (int)strcspn(argument + 2, "="), argument + 2);
		nearest = settings_nearest(name);
	}
	snprintf(sentence, sizeof(sentence), "%.100s: there is no such option%s%s%s", argument,
			 nearest ? "; did you mean --" : "", nearest ? nearest : "", nearest ? "?" : "");
	return usage_error(sentence);
}

/* -1 to go on, otherwise an exit status. */
static int read_arguments(struct settings *settings, int argc, char **argv)
{
	struct error error = {""};
	for (int i = 1; i < argc; i++) {
		if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
			print_help();
			return 0;
		}
		if (strcmp(argv[i], "--version") == 0) {
			printf("pursuitd %s\n", PURSUITD_VERSION);
			return 0;
		}
		if (strcmp(argv[i], "--print-config") == 0) {
			settings_print_config(stdout);
			return 0;
		}
		if (strcmp(argv[i], "--print-options") == 0) { /* for the programs that make man page and completions */
			settings_print_options(ALL_GROUPS, stdout);
			return 0;
		}
		int taken = take_config(settings, argc, argv, &i, &error);
		if (taken == 0)
			taken = settings_argument(settings, ALL_GROUPS, argc, argv, &i, &error);
		if (taken < 0)
			return usage_error(error.text);
		if (taken == 0)
			return refuse_argument(argv[i]);
	}
	/* Users that there are not would lock out whom they were meant to let in. */
	if (live_check(settings, &error) < 0 || presenter_check_list(settings->present, &error) < 0)
		return usage_error(error.text);
	return -1;
}

/* ---- running ---- */

/* Command line and files again; with a mistake in them all stays as it is. */
static void reload(struct pursuitd *daemon)
{
	struct settings fresh;
	notify_reloading(&daemon->log);
	settings_defaults(&fresh);
	if (read_arguments(&fresh, daemon->argc, daemon->argv) >= 0)
		log_error(&daemon->log, "SIGHUP: the settings stay as they are");
	else
		log_info(&daemon->log, "SIGHUP: settings read again, %u changed", live_reload(&daemon->live, &fresh));
	notify_ready(&daemon->log);
}

static void on_signal(void *data, int number)
{
	struct pursuitd *daemon = data;
	if (number == SIGHUP) {
		reload(daemon);
		return;
	}
	log_info(&daemon->log, "%s: stopping", number == SIGINT ? "SIGINT" : "SIGTERM");
	loop_quit(daemon->loop);
}

/*
 * A picture that is late is worth nothing, so the daemon goes before ordinary
 * programs, and so do the threads that a software renderer starts. Mostly not
 * permitted (RLIMIT_NICE): no matter then.
 */
static void raise_priority(const struct log *log)
{
	if (setpriority(PRIO_PROCESS, 0, DAEMON_NICE) < 0)
		log_debug(log, "running at ordinary priority (%s)", strerror(errno));
}

/* What tells how a latency log came to be. */
static int start_lab(struct pursuitd *daemon, struct error *error)
{
	const struct settings *settings = &daemon->settings;
	char *header = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&header, &size);
	if (!out)
		return error_set(error, -ENOMEM, "lab: out of memory");
	fprintf(out, "program: pursuitd %s\ngpio library: %s\n", PURSUITD_VERSION, chip_library());
	for (const struct option_row *row = option_table(); row->name; row++) {
		char value[1024];
		settings_get(settings, row->name, value, sizeof(value));
		fprintf(out, "setting %s = %s\n", row->name, value);
	}
	fclose(out);
	const struct lab_params params = {
		.settings = &settings->lab,
		.clock = &daemon->clock,
		.log = &daemon->log,
		.period_ns = 1e9 * (double)settings->refresh_denominator / (double)settings->refresh_numerator,
		.header = header,
	};
	daemon->lab = lab_create(&params, error);
	free(header);
	return daemon->lab ? 0 : -1;
}

/* A presenter on a console of its own reads these from a descriptor (kms_console.h); no thread exists yet. */
static void block_console_signals(void)
{
	sigset_t set;
	sigemptyset(&set);
	sigaddset(&set, SIGUSR1);
	sigaddset(&set, SIGUSR2);
	pthread_sigmask(SIG_BLOCK, &set, NULL);
}

static int start(struct pursuitd *daemon, struct error *error)
{
	static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
	signal(SIGPIPE, SIG_IGN);
	signal(SIGXFSZ, SIG_IGN); /* a file size limit is met like a full disk */
	block_console_signals();
	raise_priority(&daemon->log);
	clock_init_real(&daemon->clock);
	daemon->loop = loop_create(error);
	if (!daemon->loop || loop_add_signals(daemon->loop, signals, 3, on_signal, daemon, error) < 0)
		return -1;
	/* Before any thread: it may fork. */
	if (lab_is_wanted(&daemon->settings.lab) && start_lab(daemon, error) < 0)
		return -1;
	const struct output_params output_params = {daemon->loop, &daemon->settings, &daemon->clock, &daemon->log,
												daemon->lab};
	daemon->output = output_create(&output_params, error);
	if (!daemon->output)
		return -1;
	daemon->live = (struct live){&daemon->settings, daemon->output, &daemon->log};
	const struct control_params control_params = {daemon->loop,   &daemon->log, &daemon->clock, &daemon->settings,
												  daemon->output, daemon->lab,  &daemon->live};
	daemon->control = control_create(&control_params, error);
	if (!daemon->control)
		return -1;
	daemon->keyboard =
		(struct keyboard){.loop = daemon->loop, .log = &daemon->log, .output = daemon->output, .live = &daemon->live};
	const struct server_params server_params = {daemon->loop,      &daemon->log,   &daemon->clock,
												&daemon->settings, daemon->output, control_handle,
												daemon->control,   keyboard_press, &daemon->keyboard};
	daemon->server = server_create(&server_params, error);
	if (!daemon->server)
		return -1;
	control_set_server(daemon->control, daemon->server);
	daemon->keyboard.server = daemon->server;
	if (watchdog_create(&daemon->watchdog, daemon->loop, &daemon->log, daemon->output, error) < 0)
		return -1;
	return daemon->settings.seccomp ? seccomp_apply(error) : 0;
}

static void announce(struct pursuitd *daemon)
{
	struct output_info info;
	char refresh[64];
	output_get_info(daemon->output, &info);
	settings_get(&daemon->settings, "refresh", refresh, sizeof(refresh));
	log_info(&daemon->log, "pursuitd %s: method %s, %s at %s Hz, %s (%s)", PURSUITD_VERSION, daemon->settings.method,
			 info.presenter, refresh, info.renderer, info.context);
	log_info(&daemon->log, "listening at %s", server_path(daemon->server));
	notify_ready(&daemon->log);
}

static bool write_stats_file(const struct pursuitd *daemon, const char *text)
{
	FILE *file = fopen(daemon->settings.stats, "we");
	const bool written = file && fputs(text, file) >= 0 && fputc('\n', file) >= 0;
	const bool closed = file && fclose(file) == 0;
	if (!written || !closed)
		log_error(&daemon->log, "%s: %s", daemon->settings.stats, strerror(errno));
	return written && closed;
}

/* The last words: what was done. */
static bool tell_stats(struct pursuitd *daemon)
{
	struct stats *stats = malloc(sizeof(*stats));
	bool fine = true;
	if (stats) {
		output_get_stats(daemon->output, stats);
		log_info(&daemon->log,
				 "%" PRIu64 " real and %" PRIu64 " in-between frames shown, %" PRIu64 " in-betweens late, %" PRIu64
				 " real frames lost, %.3f%% of %" PRIu64 " vblanks on time",
				 stats->real_frames, stats->in_between_frames, stats->late_in_betweens, stats->lost_real_frames,
				 stats->vblanks_due ? 100.0 * (double)stats->vblanks_on_time / (double)stats->vblanks_due : 100.0,
				 stats->vblanks_due);
	}
	free(stats);
	if (*daemon->settings.stats) {
		char *text = control_status_text(daemon->control);
		fine = text && write_stats_file(daemon, text);
		free(text);
	}
	return fine;
}

static void stop(struct pursuitd *daemon)
{
	if (daemon->control)
		control_set_server(daemon->control, NULL);
	watchdog_destroy(&daemon->watchdog);
	server_destroy(&daemon->server);
	control_destroy(&daemon->control);
	output_destroy(&daemon->output);
	lab_destroy(&daemon->lab);
	loop_destroy(&daemon->loop);
}

int main(int argc, char **argv)
{
	struct pursuitd daemon = {.argc = argc, .argv = argv};
	struct error error = {""};
	int status;

	settings_defaults(&daemon.settings);
	status = read_arguments(&daemon.settings, argc, argv);
	if (status >= 0)
		return status;
	log_init(&daemon.log, (enum log_level)daemon.settings.log_level);
	status = 0;
	if (start(&daemon, &error) < 0) {
		log_error(&daemon.log, "%s", error.text);
		status = 1;
	} else {
		announce(&daemon);
		if (loop_run(daemon.loop, &error) < 0) {
			log_error(&daemon.log, "%s", error.text);
			status = 1;
		}
		notify_stopping(&daemon.log);
		if (!tell_stats(&daemon))
			status = 1;
	}
	stop(&daemon);
	return status;
}
