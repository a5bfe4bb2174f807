/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/packet.h"

#include <errno.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define DRAIN_MOST 256

static void collect_fds(struct packet *packet, struct msghdr *message)
{
	for (struct cmsghdr *part = CMSG_FIRSTHDR(message); part; part = CMSG_NXTHDR(message, part)) {
		if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_RIGHTS)
			continue;
		const size_t count = (part->cmsg_len - CMSG_LEN(0)) / sizeof(int);
		for (size_t i = 0; i < count; i++) {
			int fd;
			memcpy(&fd, CMSG_DATA(part) + i * sizeof(int), sizeof(fd));
			if (packet->fd_count < PACKET_FDS) {
				packet->fds[packet->fd_count++] = fd;
			} else {
				close(fd);
				packet->fds_lost = true;
			}
		}
	}
}

int packet_receive(int fd, struct packet *packet)
{
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(PACKET_FDS * sizeof(int))];
	} control;
	struct iovec part = {packet->raw, sizeof(packet->raw)};
	struct msghdr message = {
		.msg_iov = &part,
		.msg_iovlen = 1,
		.msg_control = &control,
		.msg_controllen = sizeof(control),
	};
	packet->fd_count = 0;
	const ssize_t got = recvmsg(fd, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
	if (got < 0)
		return errno == EAGAIN || errno == EINTR ? 0 : -errno;
	packet->bytes = (size_t)got;
	packet->too_long = (message.msg_flags & MSG_TRUNC) != 0 || packet->bytes > PURSUIT_WIRE_MAX_PACKET;
	packet->fds_lost = (message.msg_flags & MSG_CTRUNC) != 0;
	collect_fds(packet, &message);
	/* An empty packet looks like the end, and is treated alike. */
	if (got == 0) {
		packet_finish(packet);
		return -ECONNRESET;
	}
	return 1;
}

void packet_finish(struct packet *packet)
{
	for (uint32_t i = 0; i < packet->fd_count; i++)
		if (packet->fds[i] >= 0)
			close(packet->fds[i]);
	packet->fd_count = 0;
}

int packet_take_fd(struct packet *packet, uint32_t index)
{
	const int fd = packet->fds[index];
	packet->fds[index] = -1;
	return fd;
}

int packet_send(int socket, const void *bytes, size_t size, int fd)
{
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(sizeof(int))];
	} control = {.bytes = {0}};
	struct iovec part = {(void *)(uintptr_t)bytes, size};
	struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
	if (fd >= 0) {
		message.msg_control = &control;
		message.msg_controllen = sizeof(control);
		struct cmsghdr *rights = CMSG_FIRSTHDR(&message);
		rights->cmsg_level = SOL_SOCKET;
		rights->cmsg_type = SCM_RIGHTS;
		rights->cmsg_len = CMSG_LEN(sizeof(int));
		memcpy(CMSG_DATA(rights), &fd, sizeof(fd));
	}
	return sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL) < 0 ? -errno : 0;
}

void packet_drain(int socket)
{
	char byte;
	/* Without room for control data the kernel closes any fds. */
	for (int i = 0; i < DRAIN_MOST && recv(socket, &byte, 1, MSG_DONTWAIT | MSG_TRUNC) > 0; i++)
		;
}
