/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/x_mode_guard.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon/descriptors.h"
#include "daemon/present/x_mode.h"

#define ARGUMENT "--put-mode-back"
#define ARGUMENTS 6
/* What it is told; the pipe's end is a call as well. */
#define GOODBYE 1
#define CALL 2

/* ---- the daemon ---- */

/* The pipe's other end becomes its standard input. */
static pid_t spawn(const struct x_mode_guard_task *task, int fd)
{
	char numbers[3][24];
	const unsigned long values[] = {task->crtc, task->before, task->now};
	posix_spawn_file_actions_t actions;
	pid_t pid = 0;
	for (size_t i = 0; i < 3; i++)
		snprintf(numbers[i], sizeof(numbers[i]), "%lu", values[i]);
	const char *const argv[ARGUMENTS + 1] = {"pursuitd", ARGUMENT,   task->display, numbers[0],
											 numbers[1], numbers[2], NULL};
	posix_spawn_file_actions_init(&actions);
	posix_spawn_file_actions_adddup2(&actions, fd, STDIN_FILENO);
	if (posix_spawn(&pid, "/proc/self/exe", &actions, NULL, (char *const *)(uintptr_t)argv, environ) != 0)
		pid = 0;
	posix_spawn_file_actions_destroy(&actions);
	return pid;
}

void x_mode_guard_start(struct x_mode_guard *guard, const struct x_mode_guard_task *task)
{
	int fds[2];
	*guard = (struct x_mode_guard){0};
	if (pipe2(fds, O_CLOEXEC) < 0)
		return;
	*guard = (struct x_mode_guard){spawn(task, fds[0]), fds[1]};
	close(fds[0]);
	if (guard->pid > 0)
		return;
	close(fds[1]);
	*guard = (struct x_mode_guard){0};
}

/* A word rather than the pipe's end, which a child of the daemon's may keep open. */
static void tell(struct x_mode_guard *guard, char word)
{
	if (guard->pid > 0) {
		while (write(guard->fd, &word, 1) < 0 && errno == EINTR)
			;
		close(guard->fd);
		while (waitpid(guard->pid, NULL, 0) < 0 && errno == EINTR)
			;
	}
	*guard = (struct x_mode_guard){0};
}

void x_mode_guard_dismiss(struct x_mode_guard *guard)
{
	tell(guard, GOODBYE);
}

void x_mode_guard_call(struct x_mode_guard *guard)
{
	tell(guard, CALL);
}

/* ---- the process ---- */

/* Nothing of the daemon's is kept alive by it: pipes of a parent that waits for their end. */
static void leave_daemon(void)
{
	const int null = open("/dev/null", O_RDWR);
	prctl(PR_SET_NAME, "pursuit-guard", 0, 0, 0);
	setsid(); /* a terminal's Ctrl-C is for the daemon */
	signal(SIGINT, SIG_IGN);
	signal(SIGTERM, SIG_IGN);
	signal(SIGHUP, SIG_IGN);
	dup2(null, STDOUT_FILENO);
	dup2(null, STDERR_FILENO);
	descriptors_close(STDERR_FILENO + 1, DESCRIPTORS_ALL);
}

static void put_back(char **argv)
{
	struct x_mode mode = {
		.crtc = strtoul(argv[3], NULL, 10), .before = strtoul(argv[4], NULL, 10), .now = strtoul(argv[5], NULL, 10)};
	Display *display = XOpenDisplay(argv[2]); /* waits for one that hangs */
	if (!display)
		return;
	x_mode_restore(&mode, display);
	XCloseDisplay(display);
}

bool x_mode_guard_run(int argc, char **argv, int *status)
{
	char byte;
	ssize_t got;
	if (argc != ARGUMENTS || strcmp(argv[1], ARGUMENT) != 0)
		return false;
	leave_daemon();
	do
		got = read(STDIN_FILENO, &byte, 1);
	while (got < 0 && errno == EINTR);
	if (got <= 0 || byte == CALL)
		put_back(argv);
	*status = 0;
	return true;
}
