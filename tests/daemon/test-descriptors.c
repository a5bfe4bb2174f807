/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Descriptors are closed whatever their number is, by a kernel that knows close_range() and by one that does not. */

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon/descriptors.h"
#include "tests/test.h"

#define HIGH 3000

static bool is_old;

int __real_close_range(unsigned first, unsigned last, int flags);
int __wrap_close_range(unsigned first, unsigned last, int flags);

int __wrap_close_range(unsigned first, unsigned last, int flags)
{
	errno = ENOSYS;
	return is_old ? -1 : __real_close_range(first, last, flags);
}

static bool is_open(int fd)
{
	return fcntl(fd, F_GETFD) >= 0;
}

/* In a child, which keeps but one. */
static bool closes(int kept, int high)
{
	const pid_t pid = fork();
	int status = 0;
	if (pid == 0) {
		descriptors_close(3, (unsigned)kept - 1);
		descriptors_close((unsigned)kept + 1, DESCRIPTORS_ALL);
		_exit(is_open(kept) && is_open(2) && !is_open(kept - 1) && !is_open(kept + 1) && !is_open(high) ? 0 : 1);
	}
	CHECK(waitpid(pid, &status, 0) == pid);
	return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static void test_all(void)
{
	struct rlimit limit;
	CHECK_INT(getrlimit(RLIMIT_NOFILE, &limit), 0);
	if (limit.rlim_max <= HIGH)
		exit(77);
	limit.rlim_cur = HIGH + 1;
	CHECK_INT(setrlimit(RLIMIT_NOFILE, &limit), 0);
	const int null = open("/dev/null", O_RDONLY | O_CLOEXEC);
	CHECK(dup2(null, 10) == 10 && dup2(null, 11) == 11 && dup2(null, 12) == 12 && dup2(null, HIGH) == HIGH);
	CHECK(closes(11, HIGH));
	is_old = true;
	CHECK(closes(11, HIGH));
	CHECK(is_open(10) && is_open(HIGH));
	for (int fd = 10; fd <= 12; fd++)
		close(fd);
	close(HIGH);
	close(null);
}

/* In a child that was given some of the first three: what it opens is none of them, and what it prints goes nowhere. */
static bool fills(unsigned given)
{
	const pid_t pid = fork();
	int status = 0;
	if (pid == 0) {
		for (int fd = 0; fd < 3; fd++)
			if (!(given >> fd & 1))
				close(fd);
		descriptors_fill();
		const bool silent = given & 2 || write(STDOUT_FILENO, "x", 1) < 0;
		_exit(open("/dev/zero", O_RDONLY | O_CLOEXEC) == 3 && silent ? 0 : 1);
	}
	CHECK(waitpid(pid, &status, 0) == pid);
	return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static void test_first_three(void)
{
	descriptors_close(3, DESCRIPTORS_ALL);
	for (unsigned given = 0; given < 8; given++)
		CHECK(fills(given));
}

int main(void)
{
	RUN(test_all);
	RUN(test_first_three);
	return test_result();
}
