/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Where the daemon listens: paths that cannot be, sockets that are there already, sockets that a manager gives. */

#include <errno.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "daemon/listener.h"
#include "daemon/packet.h"
#include "tests/test.h"

static char folder[] = "/tmp/pursuit-listener-XXXXXX";

/* The linker sends the listener here (--wrap). */
static struct {
	bool bind, listen;
} fails;

int __real_bind(int fd, const struct sockaddr *address, socklen_t size);
int __real_listen(int fd, int backlog);
int __wrap_bind(int fd, const struct sockaddr *address, socklen_t size);
int __wrap_listen(int fd, int backlog);

int __wrap_bind(int fd, const struct sockaddr *address, socklen_t size)
{
	errno = EROFS;
	return fails.bind ? -1 : __real_bind(fd, address, size);
}

int __wrap_listen(int fd, int backlog)
{
	errno = ENOBUFS;
	return fails.listen ? -1 : __real_listen(fd, backlog);
}

static const char *path_of(const char *name)
{
	static char path[128];
	snprintf(path, sizeof(path), "%s/%s", folder, name);
	return path;
}

/* Listens there, or is refused with a sentence that holds this. */
static void check_path(const char *path, int want, const char *sentence)
{
	struct listener listener;
	struct error error = {""};
	const int result = listener_init(&listener, path, &error);
	CHECK_INT(result, want);
	CHECK(result == 0 || strstr(error.text, sentence) != NULL);
	if (result == 0)
		listener_finish(&listener);
	CHECK_INT(listener.fd, -1);
}

static int open_socket(const char *path, int type, bool listening)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	const int fd = socket(AF_UNIX, type | SOCK_CLOEXEC, 0);
	snprintf(address.sun_path, sizeof(address.sun_path), "%.107s", path);
	CHECK_INT(bind(fd, (struct sockaddr *)&address, sizeof(address)), 0);
	if (listening)
		CHECK_INT(listen(fd, 4), 0);
	return fd;
}

static void test_paths(void)
{
	char name[256];
	memset(name, 'x', sizeof(name) - 1);
	name[sizeof(name) - 1] = 0;
	check_path(path_of("socket"), 0, "");
	check_path(path_of("new/socket"), 0, "");
	check_path(path_of("none/none/socket"), -ENOENT, "cannot make the folder");
	check_path(name, -ENAMETOOLONG, "255 bytes long");
	setenv("XDG_RUNTIME_DIR", folder, 1);
	unsetenv("PURSUIT_SOCKET");
	check_path("", 0, "");
	CHECK_INT(access(path_of("pursuit"), F_OK), 0);
	name[104] = 0;
	setenv("XDG_RUNTIME_DIR", name, 1);
	check_path("", -ENAMETOOLONG, "bytes long");
}

static void test_what_is_there(void)
{
	struct listener first;
	struct error error = {""};
	CHECK_INT(listener_init(&first, path_of("taken"), &error), 0);
	check_path(path_of("taken"), -EADDRINUSE, "another pursuitd serves");
	listener_finish(&first);

	int fd = open_socket(path_of("other"), SOCK_SEQPACKET, true);
	check_path(path_of("other"), -EADDRINUSE, "another program serves");
	close(fd);
	check_path(path_of("other"), 0, ""); /* stale */

	fd = open(path_of("file"), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
	close(fd);
	check_path(path_of("file"), -EEXIST, "is no socket");
	check_path(path_of("file/socket"), -ENOTDIR, "cannot open");
	CHECK_INT(symlink("file", path_of("link.lock")), 0);
	check_path(path_of("link"), -ELOOP, "cannot open");
}

/* And nothing of it is left there. */
static void test_system_refuses(void)
{
	fails.bind = true;
	check_path(path_of("refused"), -EROFS, "cannot listen at");
	fails.bind = false;
	fails.listen = true;
	check_path(path_of("refused"), -ENOBUFS, "cannot listen at");
	fails.listen = false;
	CHECK(access(path_of("refused"), F_OK) != 0);
	CHECK(access(path_of("refused.lock"), F_OK) != 0);
	check_path(path_of("refused"), 0, "");
}

/* In a process of its own, whose descriptor 3 it is. */
static void check_activation(int given, int want, const char *sentence)
{
	const pid_t child = fork();
	if (child == 0) {
		struct listener listener;
		struct error error = {""};
		char pid[32];
		snprintf(pid, sizeof(pid), "%d", (int)getpid());
		setenv("LISTEN_PID", pid, 1);
		setenv("LISTEN_FDS", "1", 1);
		if (given >= 0)
			dup2(given, 3);
		else
			close(3);
		const int result = listener_init(&listener, "", &error);
		const bool fine = result == want && (result == 0 || strstr(error.text, sentence));
		listener_finish(&listener);
		exit(fine ? 0 : 1);
	}
	int status = -1;
	waitpid(child, &status, 0);
	CHECK_INT(status, 0);
}

static void test_activation(void)
{
	const int good = open_socket(path_of("activated"), SOCK_SEQPACKET, true);
	const int stream = open_socket(path_of("stream"), SOCK_STREAM, true);
	const int silent = open_socket(path_of("silent"), SOCK_SEQPACKET, false);
	check_activation(good, 0, "");
	check_activation(stream, -EINVAL, "socket activation: fd 3 is no listening");
	check_activation(silent, -EINVAL, "ListenSequentialPacket=");
	check_activation(-1, -EINVAL, "socket activation");
	close(good);
	close(stream);
	close(silent);
}

/* What else the kernel may put beside a packet is passed over, and its descriptors are taken all the same. */
static void test_other_control_data(void)
{
	struct packet *packet = calloc(1, sizeof(*packet));
	int pair[2], on = 1;
	CHECK_INT(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair), 0);
	CHECK_INT(setsockopt(pair[0], SOL_SOCKET, SO_PASSCRED, &on, sizeof(on)), 0);
	CHECK_INT(send(pair[1], "hello", 5, 0), 5);
	CHECK_INT(packet_receive(pair[0], packet), 1);
	CHECK_INT(packet->bytes, 5);
	CHECK_INT(packet->fd_count, 0);
	packet_finish(packet);
	close(pair[0]);
	close(pair[1]);
	free(packet);
}

/* A game that is told such a path renders on without a daemon. */
static void test_path_of_a_client(void)
{
	char name[256];
	memset(name, 'x', sizeof(name) - 1);
	name[sizeof(name) - 1] = 0;
	setenv("PURSUIT_SOCKET", name, 1);
	const struct pursuit_stream_params params = {.width = 16, .height = 16};
	struct pursuit_stream *stream = pursuit_open(&params);
	struct pursuit_status status = {.state = PURSUIT_STATE_ATTACHED};
	for (int i = 0; i < 3 && stream; i++) {
		struct pursuit_frame *frame = pursuit_acquire(stream);
		if (frame)
			pursuit_submit(stream, frame);
		usleep(10000);
		pursuit_get_status(stream, &status);
	}
	CHECK(!stream || status.state != PURSUIT_STATE_ATTACHED);
	pursuit_close(&stream);
}

int main(void)
{
	char command[64];
	if (!mkdtemp(folder))
		return 1;
	RUN(test_paths);
	RUN(test_what_is_there);
	RUN(test_system_refuses);
	RUN(test_activation);
	RUN(test_other_control_data);
	RUN(test_path_of_a_client);
	snprintf(command, sizeof(command), "rm -rf '%s'", folder);
	CHECK_INT(system(command), 0);
	return test_result();
}
