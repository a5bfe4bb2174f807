/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "demo_daemon.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "daemon/options.h"
#include "interrupt.h"

#define START_LIMIT_MS 60000
#define STOP_LIMIT_MS 30000
#define STEP_MS 20
#define MAX_ARGUMENTS OPTION_ROWS
#define PATH_SIZE 1024

static void wait_step(void)
{
	const struct timespec step = {0, STEP_MS * 1000000L};
	nanosleep(&step, NULL);
}

/* The folder of the running program, with what follows it. */
static bool beside(const char *follows, char *path, size_t size)
{
	ssize_t length = readlink("/proc/self/exe", path, size - 1);
	if (length <= 0)
		return false;
	path[length] = '\0';
	char *slash = strrchr(path, '/');
	if (!slash)
		return false;
	size_t used = (size_t)(slash - path);
	return (size_t)snprintf(slash, size - used, "/%s", follows) < size - used && access(path, X_OK) == 0;
}

/* "pursuitd" alone is looked up in PATH. */
static const char *find_daemon(char *path, size_t size)
{
	static const char *const places[] = {"pursuitd", "../pursuitd", "../libexec/pursuitd", "../lib/pursuit/pursuitd"};
	for (size_t i = 0; i < sizeof(places) / sizeof(*places); i++) {
		if (beside(places[i], path, size))
			return path;
	}
	return "pursuitd";
}

/* In the child. A terminal's Ctrl-C is for the demo, which then ends the daemon; without the demo it has no reason. */
static void become_daemon(const char *program, char *const *arguments, int log, int failure, pid_t parent)
{
	setpgid(0, 0);
	prctl(PR_SET_PDEATHSIG, SIGTERM);
	if (getppid() == parent) {
		dup2(log, STDOUT_FILENO);
		dup2(log, STDERR_FILENO);
		execvp(program, arguments);
	}
	int why = errno;
	ssize_t ignored = write(failure, &why, sizeof(why));
	(void)ignored;
	_exit(127);
}

static int spawn(struct demo_daemon *daemon, const char *program, char *const *arguments, struct error *error)
{
	int failure[2], why = 0;
	int log = open(daemon->log, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
	if (log < 0)
		return error_set(error, -errno, "%s: %s", daemon->log, strerror(errno));
	if (pipe2(failure, O_CLOEXEC) < 0) {
		close(log);
		return error_set(error, -errno, "no pipe: %s", strerror(errno));
	}
	fflush(NULL);
	pid_t parent = getpid(), pid = fork();
	if (pid == 0)
		become_daemon(program, arguments, log, failure[1], parent);
	close(log);
	close(failure[1]);
	ssize_t told = pid > 0 ? read(failure[0], &why, sizeof(why)) : 0;
	close(failure[0]);
	if (pid < 0)
		return error_set(error, -EAGAIN, "no process for the daemon");
	if (told == (ssize_t)sizeof(why)) {
		waitpid(pid, NULL, 0);
		return error_set(error, -ENOENT, "pursuitd was not found beside this program nor in PATH (%s)", strerror(why));
	}
	daemon->pid = pid;
	return 0;
}

/* What the daemon said last, for the sentence of a failure; hints without its name in front say nothing here. */
static void last_words(const char *path, char *text, size_t size)
{
	char line[256];
	FILE *file = fopen(path, "r");
	text[0] = '\0';
	while (file && fgets(line, sizeof(line), file))
		if (strstr(line, "pursuitd: "))
			snprintf(text, size, "%.*s", (int)strcspn(line, "\n"), line);
	if (file)
		fclose(file);
}

static int wait_until_ready(struct demo_daemon *daemon, struct error *error)
{
	char words[256];
	for (int waited = 0; waited < START_LIMIT_MS && !interrupt_seen(); waited += STEP_MS) {
		if (!demo_daemon_lives(daemon)) {
			last_words(daemon->log, words, sizeof(words));
			return error_set(error, -ECHILD, "pursuitd ended at once: %s (all of it in %s)", words, daemon->log);
		}
		if (access(daemon->socket, F_OK) == 0 && control_open(&daemon->control, daemon->socket, error) == 0)
			return 0;
		wait_step();
	}
	return error_set(error, -ETIMEDOUT, "pursuitd did not answer within %d s; see %s", START_LIMIT_MS / 1000,
					 daemon->log);
}

int demo_daemon_start(struct demo_daemon *daemon, const char *const *arguments, const char *log, struct error *error)
{
	char found[PATH_SIZE];
	const char *temporary = getenv("TMPDIR");
	char *all[MAX_ARGUMENTS + 4] = {NULL};
	unsigned count = 0;
	*daemon = (struct demo_daemon){.log = log, .control = {.fd = -1}};
	if (!temporary || strlen(temporary) > 40)
		temporary = "/tmp";
	snprintf(daemon->folder, sizeof(daemon->folder), "%s/pursuit-XXXXXX", temporary);
	if (!mkdtemp(daemon->folder)) {
		int why = errno;
		int result = error_set(error, -why, "%s: no folder for the socket: %s", daemon->folder, strerror(why));
		daemon->folder[0] = '\0';
		return result;
	}
	snprintf(daemon->socket, sizeof(daemon->socket), "%s/socket", daemon->folder);
	all[count++] = (char *)(uintptr_t) "pursuitd";
	all[count++] = (char *)(uintptr_t) "--socket";
	all[count++] = daemon->socket;
	for (; *arguments && count < MAX_ARGUMENTS + 3; arguments++)
		all[count++] = (char *)(uintptr_t)*arguments;
	int result = spawn(daemon, find_daemon(found, sizeof(found)), all, error);
	return result == 0 ? wait_until_ready(daemon, error) : result;
}

bool demo_daemon_lives(struct demo_daemon *daemon)
{
	if (daemon->pid && waitpid(daemon->pid, NULL, WNOHANG) != 0)
		daemon->pid = 0;
	return daemon->pid != 0;
}

static int reap(struct demo_daemon *daemon, struct error *error)
{
	int status = 0;
	pid_t ended = 0;
	kill(daemon->pid, SIGTERM);
	for (int waited = 0; waited < STOP_LIMIT_MS && ended == 0; waited += STEP_MS) {
		ended = waitpid(daemon->pid, &status, WNOHANG);
		if (ended == 0)
			wait_step();
	}
	if (ended == 0) {
		kill(daemon->pid, SIGKILL);
		waitpid(daemon->pid, NULL, 0);
		return error_set(error, -ECHILD, "pursuitd did not end within %d s and was killed", STOP_LIMIT_MS / 1000);
	}
	if (ended < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
		return error_set(error, -ECHILD, "pursuitd ended badly (%s %d); see %s",
						 WIFSIGNALED(status) ? "signal" : "status",
						 WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status), daemon->log);
	return 0;
}

/* A daemon that died left its socket and its lock behind; nobody else has files in this folder. */
static void remove_folder(const char *path)
{
	DIR *folder = *path ? opendir(path) : NULL;
	if (!folder)
		return;
	for (struct dirent *entry; (entry = readdir(folder));) {
		if (strcmp(entry->d_name, ".") && strcmp(entry->d_name, ".."))
			unlinkat(dirfd(folder), entry->d_name, 0);
	}
	closedir(folder);
	rmdir(path);
}

int demo_daemon_stop(struct demo_daemon *daemon, struct error *error)
{
	int result = 0;
	bool started = daemon->control.fd >= 0;
	control_close(&daemon->control);
	if (demo_daemon_lives(daemon))
		result = reap(daemon, error);
	else if (started)
		result = error_set(error, -ECHILD, "pursuitd died; see %s", daemon->log);
	daemon->pid = 0;
	remove_folder(daemon->folder);
	return result;
}
