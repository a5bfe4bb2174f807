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

#include "daemon/arguments.h"
#include "daemon/clock.h"
#include "daemon/control.h"
#include "daemon/descriptors.h"
#include "daemon/keyboard.h"
#include "daemon/lab/lab.h"
#include "daemon/live.h"
#include "daemon/log.h"
#include "daemon/loop.h"
#include "daemon/notify.h"
#include "daemon/options.h"
#include "daemon/output.h"
#include "daemon/owners.h"
#include "daemon/present/presenter.h"
#include "daemon/present/x_mode_guard.h"
#include "daemon/reload.h"
#include "daemon/seccomp.h"
#include "daemon/server.h"
#include "daemon/version.h"

#define EXIT_USAGE 2
#define DAEMON_NICE (-3)

struct pursuitd {
	struct settings settings;
	struct log log;
	struct clock clock;
	struct loop *loop;
	struct lab *lab;
	struct closer *closer;
	struct admission *admission;
	struct owners owners;
	struct output *output;
	struct live live;
	struct reload reload;
	struct control *control;
	struct server *server;
	struct keyboard keyboard;
	struct watchdog *watchdog;
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

static void print_config(void)
{
	configuration_print(stdout);
}

/* For the programs that make man page and completions. */
static void print_options(void)
{
	settings_print_options(ALL_GROUPS, stdout);
}

static void print_version(void)
{
	printf("pursuitd %s\n", PURSUITD_VERSION);
}

static int printed(void)
{
	const int result = fflush(stdout) == 0 ? 0 : errno;
	if (result == 0 && !ferror(stdout))
		return 0;
	fprintf(stderr, "pursuitd: standard output cannot be written%s%s\n", result ? ": " : "",
			result ? strerror(result) : "");
	return 1;
}

/* Is there an argument that asks for text and nothing else? */
static bool tell(int argc, char **argv)
{
	static const struct {
		const char *name;
		void (*print)(void);
	} texts[] = {
		{"--help", print_help},
		{"-h", print_help},
		{"--version", print_version},
		{"--print-config", print_config},
		{"--print-options", print_options},
	};
	for (int i = 1; i < argc; i++) {
		for (size_t j = 0; j < sizeof(texts) / sizeof(texts[0]); j++) {
			if (strcmp(argv[i], texts[j].name) == 0) {
				texts[j].print();
				return true;
			}
		}
	}
	return false;
}

/* ---- running ---- */

static void reload(struct pursuitd *daemon)
{
	struct error error;
	notify_reloading(&daemon->log);
	reload_now(&daemon->reload, "SIGHUP", &error);
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
	if (owners_keep_files(NULL, &daemon->settings, &daemon->log, NULL, error) < 0)
		return -1;
	/* Before any thread: it may fork. */
	daemon->lab = owners_create_lab(&daemon->settings, &daemon->clock, &daemon->log, error);
	daemon->closer = closer_create(error);
	if (!daemon->lab || !daemon->closer)
		return -1;
	const struct output_params output_params = {daemon->loop, &daemon->settings, &daemon->clock, &daemon->log,
												daemon->lab,  daemon->closer,    live_show,      &daemon->live};
	daemon->output = output_create(&output_params, error);
	if (!daemon->output)
		return -1;
	daemon->live.output = daemon->output;
	const struct control_params control_params = {daemon->loop,      &daemon->log,    &daemon->clock,
												  &daemon->settings, daemon->output,  daemon->lab,
												  &daemon->live,     &daemon->reload, daemon->closer};
	daemon->control = control_create(&control_params, error);
	if (!daemon->control)
		return -1;
	daemon->keyboard =
		(struct keyboard){.loop = daemon->loop, .log = &daemon->log, .output = daemon->output, .live = &daemon->live};
	const struct server_params server_params = {daemon->loop,      &daemon->log,     &daemon->clock,  &daemon->settings,
												daemon->output,    control_handle,   daemon->control, keyboard_press,
												&daemon->keyboard, daemon->admission};
	daemon->server = server_create(&server_params, error);
	if (!daemon->server)
		return -1;
	control_set_server(daemon->control, daemon->server);
	daemon->keyboard.server = daemon->server;
	if (admission_watch(daemon->admission, daemon->loop, error) < 0)
		return -1;
	daemon->owners = (struct owners){.server = daemon->server,
									 .admission = daemon->admission,
									 .capture = control_get_capture(daemon->control),
									 .lab = daemon->lab,
									 .output = daemon->output,
									 .log = &daemon->log,
									 .closer = daemon->closer};
	owners_add(&daemon->live, &daemon->owners);
	reload_watch(&daemon->reload, daemon->loop);
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
	if (daemon->output)
		output_stop(daemon->output);
	server_destroy(&daemon->server);
	admission_destroy(&daemon->admission);
	control_destroy(&daemon->control);
	output_destroy(&daemon->output);
	closer_destroy(&daemon->closer);
	lab_destroy(&daemon->lab);
	reload_finish(&daemon->reload);
	live_finish(&daemon->live);
	loop_destroy(&daemon->loop);
}

int main(int argc, char **argv)
{
	struct pursuitd daemon = {0};
	struct arguments arguments;
	struct error error = {""};
	int status;

	descriptors_fill();
	if (x_mode_guard_run(argc, argv, &status))
		return status;
	if (tell(argc, argv))
		return printed();
	if (arguments_read(&arguments, argc, argv, &error) < 0) {
		arguments_finish(&arguments);
		return usage_error(error.text);
	}
	daemon.settings = arguments.settings;
	log_init(&daemon.log, (enum log_level)daemon.settings.log_level);
	const struct admission_params admission_params = {.log = &daemon.log, .settings = &daemon.settings};
	/* Names that there are not would lock out whom they were meant to let in. */
	daemon.admission = admission_create(&admission_params, &error);
	if (!daemon.admission) {
		origins_tell(arguments.origins, &error);
		arguments_finish(&arguments);
		return usage_error(error.text);
	}
	live_init(&daemon.live, &daemon.settings, &arguments.profiles, &daemon.log);
	memcpy(daemon.live.origins, arguments.origins, sizeof(daemon.live.origins));
	reload_init(&daemon.reload, &daemon.live, &daemon.log, &arguments, argc, argv);
	status = 0;
	if (start(&daemon, &error) < 0) {
		origins_tell(daemon.live.origins, &error);
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
