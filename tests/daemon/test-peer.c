/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The process at the other end of a socket: with kernels that know of it, that do not, and that know it has ended. */

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon/peer.h"
#include "tests/test.h"

#define PEER_PIDFD 77

static int failure; /* what the kernel answers instead; 0: what it does answer */

int __real_getsockopt(int socket, int level, int option, void *value, socklen_t *size);
int __wrap_getsockopt(int socket, int level, int option, void *value, socklen_t *size);

int __wrap_getsockopt(int socket, int level, int option, void *value, socklen_t *size)
{
	if (!failure || option != PEER_PIDFD)
		return __real_getsockopt(socket, level, option, value, size);
	errno = failure;
	return -1;
}

/* A process that is there, and has the number that the peer had. */
static pid_t start_other(void)
{
	fflush(stdout);
	const pid_t child = fork();
	if (child == 0) {
		pause();
		_exit(0);
	}
	return child;
}

static void end_other(pid_t child)
{
	kill(child, SIGKILL);
	CHECK_INT(waitpid(child, NULL, 0), child);
}

static pid_t number_of(int process)
{
	char path[32], line[128];
	int number = -1;
	snprintf(path, sizeof(path), "/proc/self/fdinfo/%d", process);
	FILE *file = fopen(path, "re");
	while (file && fgets(line, sizeof(line), file) && sscanf(line, "Pid: %d", &number) != 1)
		;
	if (file)
		fclose(file);
	return number;
}

/* Before Linux 6.5 there is but the number. */
static void test_kernel_without(void)
{
	const pid_t other = start_other();
	failure = ENOPROTOOPT;
	const int process = peer_open_process(-1, other);
	CHECK(process >= 0);
	CHECK_INT(number_of(process), other);
	close(process);
	end_other(other);
}

/* From Linux 6.5 to 6.15 an error says that the peer has ended: whoever has its number now is another. */
static void test_peer_that_has_ended(void)
{
	static const int errors[] = {EINVAL, ESRCH, ENODATA, EMFILE, EPERM};
	const pid_t other = start_other();
	for (size_t i = 0; i < sizeof(errors) / sizeof(errors[0]); i++) {
		failure = errors[i];
		CHECK_INT(peer_open_process(-1, other), -1);
	}
	end_other(other);
}

/* The kernel that there is, old or new: while the peer lives it is that one; when it is gone it is nobody else. */
static void test_this_kernel(void)
{
	int ends[2];
	failure = 0;
	CHECK_INT(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends), 0);
	const int process = peer_open_process(ends[0], getpid());
	CHECK(process >= 0);
	CHECK_INT(number_of(process), getpid());
	CHECK_INT(poll(&(struct pollfd){process, POLLIN, 0}, 1, 0), 0);
	close(process);
	close(ends[0]);
	close(ends[1]);
	CHECK_INT(peer_open_process(-1, 0), -1);
	CHECK_INT(peer_open_process(-1, getpid()), -1);
}

int main(void)
{
	RUN(test_kernel_without);
	RUN(test_peer_that_has_ended);
	RUN(test_this_kernel);
	return test_result();
}
