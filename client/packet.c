/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "client/packet.h"

#include <errno.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

union control {
	struct cmsghdr align;
	char bytes[CMSG_SPACE(sizeof(int) * SHIM_PACKET_FDS)];
};

int shim_packet_connect(const char *path)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	size_t length = strlen(path);

	if (length >= sizeof(address.sun_path)) {
		return -ENAMETOOLONG;
	}
	memcpy(address.sun_path, path, length);
	int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	if (fd < 0) {
		return -errno;
	}
	if (connect(fd, (const struct sockaddr *)&address, sizeof(address)) < 0) {
		int error = errno;
		close(fd);
		return -error;
	}
	return fd;
}

int shim_packet_send(int socket, const void *bytes, size_t size, const int *fds, int fd_count)
{
	struct iovec vector = {.iov_len = size};
	struct msghdr message = {.msg_iov = &vector, .msg_iovlen = 1};
	union control control;
	ssize_t sent;

	memcpy(&vector.iov_base, &bytes, sizeof(bytes)); /* iov_base is not const, though sendmsg() only reads */
	if (fd_count > 0) {
		memset(&control, 0, sizeof(control));
		message.msg_control = &control;
		message.msg_controllen = CMSG_SPACE(sizeof(int) * (size_t)fd_count);
		struct cmsghdr *rights = CMSG_FIRSTHDR(&message);
		rights->cmsg_level = SOL_SOCKET;
		rights->cmsg_type = SCM_RIGHTS;
		rights->cmsg_len = CMSG_LEN(sizeof(int) * (size_t)fd_count);
		memcpy(CMSG_DATA(rights), fds, sizeof(int) * (size_t)fd_count);
	}
	do {
		sent = sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL);
	} while (sent < 0 && errno == EINTR);
	return sent < 0 ? -errno : 0;
}

static void collect_fds(struct shim_packet *packet, struct msghdr *message)
{
	for (struct cmsghdr *part = CMSG_FIRSTHDR(message); part; part = CMSG_NXTHDR(message, part)) {
		if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_RIGHTS) {
			continue;
		}
		size_t count = (part->cmsg_len - CMSG_LEN(0)) / sizeof(int);
		for (size_t i = 0; i < count; i++) {
			int fd;
			memcpy(&fd, CMSG_DATA(part) + i * sizeof(int), sizeof(int));
			if (packet->fd_count < SHIM_PACKET_FDS) {
				packet->fds[packet->fd_count++] = fd;
			} else {
				close(fd);
				packet->fds_lost = true;
			}
		}
	}
}

int shim_packet_receive(int socket, struct shim_packet *packet)
{
	struct iovec vector = {.iov_base = packet, .iov_len = sizeof(struct pursuit_message_refused)};
	union control control;
	struct msghdr message = {.msg_iov = &vector, .msg_iovlen = 1, .msg_control = &control};
	bool reset = false;
	ssize_t got;

	memset(packet, 0, sizeof(*packet));
	for (;;) {
		message.msg_controllen = sizeof(control);
		got = recvmsg(socket, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
		/* A peer that closes with something unread resets us, ahead of what it said last. */
		if (got < 0 && errno == ECONNRESET && !reset) {
			reset = true;
		} else if (got >= 0 || errno != EINTR) {
			break;
		}
	}
	if (got < 0) {
		return errno == EAGAIN && !reset ? 0 : errno == EAGAIN ? -EPIPE : -errno;
	}
	packet->bytes = (size_t)got;
	packet->truncated = (message.msg_flags & MSG_TRUNC) != 0;
	packet->fds_lost = (message.msg_flags & MSG_CTRUNC) != 0;
	collect_fds(packet, &message);
	if (got == 0) {
		shim_packet_finish(packet);
		return -EPIPE;
	}
	return 1;
}

void shim_packet_finish(struct shim_packet *packet)
{
	while (packet->fd_count > 0) {
		close(packet->fds[--packet->fd_count]);
	}
}

int shim_packet_take_fd(struct shim_packet *packet)
{
	if (packet->fd_count != 1 || packet->fds_lost) {
		return -1;
	}
	packet->fd_count = 0;
	return packet->fds[0];
}
