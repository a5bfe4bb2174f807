/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/guard.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "daemon/descriptors.h"

#define TRIES 2000
#define TRY_NS 1000000L

/* The daemon is dead: takes the line as soon as the kernel gives it. */
static void make_safe(const struct chip_params *params)
{
	const struct timespec pause = {0, TRY_NS};
	struct error error = {""};
	for (int i = 0; i < TRIES; i++) {
		struct chip *chip = chip_open(params, &error);
		if (chip) {
			chip_close(&chip);
			return;
		}
		nanosleep(&pause, NULL);
	}
	dprintf(STDERR_FILENO, "pursuit-guard: the strobe's line could not be made safe: %s\n", error.text);
}

static void watch(int fd, const struct chip_params *params)
{
	char byte;
	ssize_t got;
	prctl(PR_SET_NAME, "pursuit-guard", 0, 0, 0);
	setsid(); /* a terminal's Ctrl-C is for the daemon */
	signal(SIGINT, SIG_IGN);
	signal(SIGTERM, SIG_IGN);
	signal(SIGHUP, SIG_IGN);
	/* Nothing of the daemon's is kept alive by it: pipes of a parent that waits for their end. */
	fd = dup2(fd, STDIN_FILENO);
	close(STDOUT_FILENO);
	descriptors_close(STDERR_FILENO + 1, DESCRIPTORS_ALL);
	do
		got = read(fd, &byte, 1);
	while (got < 0 && errno == EINTR);
	if (got <= 0)
		make_safe(params);
	_exit(0);
}

int guard_start(struct guard *guard, const struct chip_params *params, struct error *error)
{
	int fds[2];
	if (pipe2(fds, O_CLOEXEC) < 0)
		return error_set(error, -errno, "strobe: no pipe for its guard: %s", strerror(errno));
	guard->pid = fork();
	if (guard->pid == 0) {
		close(fds[1]);
		watch(fds[0], params);
	}
	close(fds[0]);
	guard->fd = fds[1];
	if (guard->pid > 0)
		return 0;
	close(fds[1]);
	guard->pid = 0;
	return error_set(error, -errno, "strobe: no process for its guard: %s", strerror(errno));
}

void guard_dismiss(struct guard *guard)
{
	const char goodbye = 1;
	if (guard->pid <= 0)
		return;
	while (write(guard->fd, &goodbye, 1) < 0 && errno == EINTR)
		;
	close(guard->fd);
	waitpid(guard->pid, NULL, 0);
	guard->pid = 0;
}
