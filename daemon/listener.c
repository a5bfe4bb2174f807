/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/listener.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#define FIRST_ACTIVATED_FD 3
#define BACKLOG 32

/* ---- systemd ---- */

/* Is there a socket that systemd opened for this process? */
static bool is_activated(void)
{
	const char *pid = getenv("LISTEN_PID"), *count = getenv("LISTEN_FDS");
	const bool ours = pid && count && strtol(pid, NULL, 10) == (long)getpid() && strtol(count, NULL, 10) >= 1;
	unsetenv("LISTEN_PID");
	unsetenv("LISTEN_FDS");
	unsetenv("LISTEN_FDNAMES");
	return ours;
}

static int option_of(int fd, int option)
{
	int value = -1;
	socklen_t size = sizeof(value);
	return getsockopt(fd, SOL_SOCKET, option, &value, &size) < 0 ? -1 : value;
}

static int take_activated(struct listener *listener, struct error *error)
{
	const int fd = FIRST_ACTIVATED_FD;
	struct sockaddr_un address = {0};
	socklen_t size = sizeof(address) - 1;
	if (option_of(fd, SO_DOMAIN) != AF_UNIX || option_of(fd, SO_TYPE) != SOCK_SEQPACKET ||
		option_of(fd, SO_ACCEPTCONN) != 1)
		return error_set(error, -EINVAL,
						 "socket activation: fd %d is no listening AF_UNIX SOCK_SEQPACKET socket; use "
						 "ListenSequentialPacket= in the socket unit",
						 fd);
	if (fcntl(fd, F_SETFD, FD_CLOEXEC) < 0 || fcntl(fd, F_SETFL, O_NONBLOCK) < 0)
		return error_set(error, -errno, "socket activation: %s", strerror(errno));
	if (getsockname(fd, (struct sockaddr *)&address, &size) == 0)
		snprintf(listener->path, sizeof(listener->path), "%.107s", address.sun_path);
	listener->fd = fd;
	return 0;
}

/* ---- a path ---- */

static int choose_path(struct listener *listener, const char *path, struct error *error)
{
	const char *given = *path ? path : getenv("PURSUIT_SOCKET");
	const char *runtime = getenv("XDG_RUNTIME_DIR");
	int length;
	if (given && *given)
		length = snprintf(listener->path, sizeof(listener->path), "%s", given);
	else
		length = snprintf(listener->path, sizeof(listener->path), "%s/pursuit/socket",
						  runtime && *runtime ? runtime : "/run");
	if (length >= (int)sizeof(listener->path))
		return error_set(error, -ENAMETOOLONG, "socket: \"%.80s...\" is %d bytes long, must be at most %zu",
						 given ? given : listener->path, length, sizeof(listener->path) - 1);
	return 0;
}

static int make_folder(const struct listener *listener, struct error *error)
{
	char folder[sizeof(listener->path)];
	memcpy(folder, listener->path, sizeof(folder));
	char *slash = strrchr(folder, '/');
	if (!slash || slash == folder)
		return 0;
	*slash = 0;
	if (mkdir(folder, 0700) == 0 || errno == EEXIST)
		return 0;
	return error_set(error, -errno, "socket: cannot make the folder %s: %s; set XDG_RUNTIME_DIR or --socket", folder,
					 strerror(errno));
}

static void lock_path(const struct listener *listener, char path[128])
{
	snprintf(path, 128, "%s.lock", listener->path);
}

/* One daemon a path: held until the end, so that the look for a stale socket races with nobody. */
static int take_lock(struct listener *listener, struct error *error)
{
	char path[128];
	lock_path(listener, path);
	for (;;) {
		struct stat ours, there;
		const int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
		if (fd < 0)
			return error_set(error, -errno, "socket: cannot open %s: %s", path, strerror(errno));
		if (flock(fd, LOCK_EX | LOCK_NB) < 0) {
			close(fd);
			return error_set(error, -EADDRINUSE, "socket: another pursuitd serves %s", listener->path);
		}
		if (fstat(fd, &ours) == 0 && stat(path, &there) == 0 && ours.st_ino == there.st_ino) {
			listener->lock_fd = fd;
			return 0;
		}
		close(fd); /* its owner has just removed it */
	}
}

/* 0 if nothing is there (any more). */
static int remove_stale(const struct listener *listener, const struct sockaddr_un *address, struct error *error)
{
	struct stat status;
	if (lstat(listener->path, &status) < 0)
		return errno == ENOENT ? 0 : error_set(error, -errno, "socket: %s: %s", listener->path, strerror(errno));
	if (!S_ISSOCK(status.st_mode))
		return error_set(error, -EEXIST, "socket: %s is there and is no socket", listener->path);
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	const bool answered =
		fd < 0 || connect(fd, (const struct sockaddr *)address, sizeof(*address)) == 0 || errno != ECONNREFUSED;
	if (fd >= 0)
		close(fd);
	if (answered)
		return error_set(error, -EADDRINUSE, "socket: another program serves %s", listener->path);
	unlink(listener->path);
	return 0;
}

static int bind_path(struct listener *listener, struct error *error)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	memcpy(address.sun_path, listener->path, sizeof(address.sun_path));
	int result = remove_stale(listener, &address, error);
	if (result < 0)
		return result;
	listener->fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (listener->fd < 0)
		return error_set(error, -errno, "socket: %s", strerror(errno));
	if (bind(listener->fd, (struct sockaddr *)&address, sizeof(address)) == 0) {
		if (listen(listener->fd, BACKLOG) == 0)
			return 0;
		result = -errno;
		unlink(listener->path);
	} else {
		result = -errno;
	}
	close(listener->fd);
	listener->fd = -1;
	return error_set(error, result, "socket: cannot listen at %s: %s", listener->path, strerror(-result));
}

int listener_init(struct listener *listener, const char *path, struct error *error)
{
	*listener = (struct listener){.fd = -1, .lock_fd = -1};
	if (is_activated())
		return take_activated(listener, error);
	int result = choose_path(listener, path, error);
	if (result == 0)
		result = make_folder(listener, error);
	if (result == 0)
		result = take_lock(listener, error);
	if (result == 0)
		result = bind_path(listener, error);
	if (result < 0)
		listener_finish(listener);
	return result;
}

bool listener_is_at(const struct listener *listener, const char *path)
{
	struct listener other = {.fd = -1};
	struct error error;
	return choose_path(&other, path, &error) == 0 && strcmp(other.path, listener->path) == 0;
}

void listener_finish(struct listener *listener)
{
	char path[128];
	if (listener->fd >= 0) {
		close(listener->fd);
		if (listener->lock_fd >= 0)
			unlink(listener->path);
	}
	if (listener->lock_fd >= 0) {
		lock_path(listener, path);
		unlink(path);
		close(listener->lock_fd);
	}
	listener->fd = listener->lock_fd = -1;
}
