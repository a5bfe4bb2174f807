/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/daemon/fixture.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/daemon/raw-client.h"

#define MAX_ARGUMENTS 32
/* Said by a daemon that ends because a display server was not let run for two seconds. */
#define SILENT "error: glfw: the display server does not answer"

uint64_t now_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

void sleep_ms(unsigned ms)
{
	const struct timespec span = {ms / 1000, (long)(ms % 1000) * 1000000};
	nanosleep(&span, NULL);
}

void fixture_init(struct fixture *fixture, const char *program)
{
	memset(fixture, 0, sizeof(*fixture));
	fixture->program = program;
	snprintf(fixture->folder, sizeof(fixture->folder), "/tmp/pursuit-test-XXXXXX");
	if (!mkdtemp(fixture->folder)) {
		perror("mkdtemp");
		exit(1);
	}
	snprintf(fixture->socket, sizeof(fixture->socket), "%s/socket", fixture->folder);
	snprintf(fixture->log, sizeof(fixture->log), "%s/log", fixture->folder);
}

static void print_log(const struct fixture *fixture)
{
	char command[128];
	snprintf(command, sizeof(command), "cat '%s' >&2", fixture->log);
	if (system(command) != 0)
		perror(command);
}

void fixture_finish(struct fixture *fixture)
{
	char command[128];
	if (fixture->pid > 0)
		fixture_stop(fixture, SIGKILL);
	if (test_failed())
		print_log(fixture);
	snprintf(command, sizeof(command), "rm -rf '%s'", fixture->folder);
	if (system(command) != 0)
		perror(command);
}

void fixture_spawn(struct fixture *fixture, const char *const *arguments)
{
	const char *argv[MAX_ARGUMENTS] = {fixture->program, "--method", "hold", "--socket", fixture->socket};
	int count = 5;
	while (arguments && *arguments && count < MAX_ARGUMENTS - 1)
		argv[count++] = *arguments++;
	fflush(stdout);
	fixture->pid = fork();
	if (fixture->pid != 0)
		return;
	const int log = open(fixture->log, O_WRONLY | O_CREAT | O_APPEND, 0600);
	dup2(log, STDERR_FILENO);
	setenv("UBSAN_OPTIONS", "halt_on_error=1:print_stacktrace=1", 0); /* of builds with -Db_sanitize */
	execv(fixture->program, (char *const *)(uintptr_t)argv);
	perror(fixture->program);
	_exit(127);
}

static bool answers(const struct fixture *fixture)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	snprintf(address.sun_path, sizeof(address.sun_path), "%s", fixture->socket);
	const bool connected = connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0;
	close(fd);
	return connected;
}

bool fixture_wait(struct fixture *fixture)
{
	for (unsigned waited = 0; waited < PATIENCE_MS; waited += 10) {
		siginfo_t info = {.si_pid = 0};
		if (answers(fixture))
			return true;
		if (waitid(P_PID, (id_t)fixture->pid, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid != 0)
			return false;
		sleep_ms(10);
	}
	return false;
}

unsigned fixture_count_logged(const struct fixture *fixture, const char *text)
{
	unsigned count = 0;
	static char content[1 << 20];
	const int fd = open(fixture->log, O_RDONLY);
	const ssize_t length = fd >= 0 ? read(fd, content, sizeof(content) - 1) : -1;
	if (fd >= 0)
		close(fd);
	content[length < 0 ? 0 : length] = 0;
	for (const char *at = content; (at = strstr(at, text)) != NULL; at++)
		count++;
	return count;
}

void fixture_start(struct fixture *fixture, const char *const *arguments)
{
	int status = 0;
	unsigned silent, before;
	do {
		before = fixture_count_logged(fixture, SILENT);
		fixture_spawn(fixture, arguments);
		if (fixture_wait(fixture))
			return;
		status = fixture_join(fixture);
		silent = fixture_count_logged(fixture, SILENT);
	} while (silent > before && silent < 20);
	const bool no_gl = status == 1 && fixture_count_logged(fixture, "ontext") > 0;
	print_log(fixture);
	fixture_finish(fixture);
	if (no_gl)
		SKIP("no GL context can be made on this machine");
	exit(1);
}

int fixture_join(struct fixture *fixture)
{
	int status = 0;
	for (unsigned waited = 0; waited < PATIENCE_MS; waited += 5) {
		if (waitpid(fixture->pid, &status, WNOHANG) == fixture->pid) {
			fixture->pid = 0;
			return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
		}
		sleep_ms(5);
	}
	kill(fixture->pid, SIGKILL);
	waitpid(fixture->pid, &status, 0);
	fixture->pid = 0;
	return -1;
}

int fixture_stop(struct fixture *fixture, int number)
{
	kill(fixture->pid, number);
	return fixture_join(fixture);
}

bool fixture_logged_often(const struct fixture *fixture, const char *text, unsigned times)
{
	for (unsigned waited = 0; waited < PATIENCE_MS && fixture_count_logged(fixture, text) < times; waited += 10)
		sleep_ms(10);
	return fixture_count_logged(fixture, text) >= times;
}

bool fixture_logged(const struct fixture *fixture, const char *text)
{
	return fixture_logged_often(fixture, text, 1);
}

int fixture_count_fds(const struct fixture *fixture)
{
	char path[64];
	int count = 0;
	snprintf(path, sizeof(path), "/proc/%d/fd", (int)fixture->pid);
	DIR *folder = opendir(path);
	while (folder && readdir(folder))
		count++;
	if (folder)
		closedir(folder);
	return count;
}

bool fixture_fds_become(const struct fixture *fixture, int count)
{
	for (unsigned waited = 0; waited < PATIENCE_MS && fixture_count_fds(fixture) != count; waited += 10)
		sleep_ms(10);
	return fixture_count_fds(fixture) == count;
}

/* Who is answered so often has seen the daemon close all that had ended before. */
static int fewest_while_it_answers(const struct fixture *fixture, int connection)
{
	static struct raw_reply reply;
	int fewest = fixture_count_fds(fixture);
	for (int i = 0; i < 50; i++) {
		raw_control(connection, "ping", -1, &reply);
		const int count = fixture_count_fds(fixture);
		fewest = count < fewest ? count : fewest;
		sleep_ms(10);
	}
	return fewest;
}

int fixture_settled_fds(const struct fixture *fixture)
{
	const int connection = raw_greet(fixture->socket);
	CHECK(connection >= 0);
	const int fewest = fewest_while_it_answers(fixture, connection);
	close(connection);
	for (unsigned waited = 0; waited < PATIENCE_MS && fixture_count_fds(fixture) >= fewest; waited += 10)
		sleep_ms(10);
	sleep_ms(50);
	return fixture_count_fds(fixture);
}
