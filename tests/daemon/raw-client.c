/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/daemon/raw-client.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/daemon/fixture.h"

#define DEPTH_OFFSET ((uint64_t)RAW_WIDTH * RAW_HEIGHT * 4)
#define MOTION_OFFSET (DEPTH_OFFSET * 2)

int raw_connect(const char *path)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	snprintf(address.sun_path, sizeof(address.sun_path), "%s", path);
	if (connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0)
		return fd;
	close(fd);
	return -1;
}

int raw_send(int socket, const void *bytes, size_t size, const int *fds, int fd_count)
{
	char control[CMSG_SPACE(64 * sizeof(int))] __attribute__((aligned(16))) = {0};
	struct iovec part = {(void *)(uintptr_t)bytes, size};
	struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
	if (fd_count > 0) {
		message.msg_control = control;
		message.msg_controllen = CMSG_SPACE((size_t)fd_count * sizeof(int));
		struct cmsghdr *rights = CMSG_FIRSTHDR(&message);
		rights->cmsg_level = SOL_SOCKET;
		rights->cmsg_type = SCM_RIGHTS;
		rights->cmsg_len = CMSG_LEN((size_t)fd_count * sizeof(int));
		memcpy(CMSG_DATA(rights), fds, (size_t)fd_count * sizeof(int));
	}
	return sendmsg(socket, &message, MSG_NOSIGNAL) < 0 ? -errno : 0;
}

bool raw_receive(int socket, struct raw_reply *reply)
{
	char control[CMSG_SPACE(RAW_FDS * sizeof(int))] __attribute__((aligned(16)));
	struct iovec part = {reply->raw, sizeof(reply->raw)};
	struct msghdr message = {
		.msg_iov = &part, .msg_iovlen = 1, .msg_control = control, .msg_controllen = sizeof(control)};
	struct pollfd wait = {socket, POLLIN, 0};
	memset(reply, 0, offsetof(struct raw_reply, raw));
	if (poll(&wait, 1, PATIENCE_MS) <= 0)
		return false;
	const ssize_t got = recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
	if (got <= 0)
		return false;
	reply->bytes = (size_t)got;
	struct cmsghdr *rights = CMSG_FIRSTHDR(&message);
	if (rights && rights->cmsg_type == SCM_RIGHTS) {
		reply->fd_count = (int)((rights->cmsg_len - CMSG_LEN(0)) / sizeof(int));
		memcpy(reply->fds, CMSG_DATA(rights), (size_t)reply->fd_count * sizeof(int));
	}
	return true;
}

bool raw_is_gone(int socket)
{
	char bytes[1024];
	for (;;) {
		struct pollfd wait = {socket, POLLIN, 0};
		if (poll(&wait, 1, PATIENCE_MS) <= 0)
			return false;
		const ssize_t got = recv(socket, bytes, sizeof(bytes), 0);
		if (got == 0 || (got < 0 && errno == ECONNRESET))
			return true;
	}
}

struct pursuit_message_hello raw_hello(void)
{
	return (struct pursuit_message_hello){
		.header = {.type = PURSUIT_MESSAGE_HELLO, .size = sizeof(struct pursuit_message_hello), .serial = 11},
		.magic = PURSUIT_WIRE_MAGIC,
		.version_min = PURSUIT_WIRE_VERSION_MIN,
		.version_max = PURSUIT_WIRE_VERSION_MAX,
		.name = "raw",
	};
}

struct pursuit_message_open_stream raw_open(uint64_t stream_id, uint32_t slots, uint64_t slot_bytes)
{
	return (struct pursuit_message_open_stream){
		.header = {.type = PURSUIT_MESSAGE_OPEN_STREAM,
				   .size = sizeof(struct pursuit_message_open_stream),
				   .serial = 12},
		.stream_id = stream_id,
		.slot_count = slots,
		.slot_bytes = slot_bytes,
	};
}

int raw_greet(const char *path)
{
	const struct pursuit_message_hello hello = raw_hello();
	struct raw_reply reply;
	const int fd = raw_connect(path);
	if (fd >= 0 && raw_send(fd, &hello, sizeof(hello), NULL, 0) == 0 && raw_receive(fd, &reply) &&
		reply.header.type == PURSUIT_MESSAGE_WELCOME)
		return fd;
	close(fd);
	return -1;
}

int raw_control(int socket, const char *text, int fd, struct raw_reply *reply)
{
	uint8_t packet[4096];
	const struct pursuit_message_control header = {
		.header = {.type = PURSUIT_MESSAGE_CONTROL, .size = (uint32_t)(sizeof(header) + strlen(text)), .serial = 13},
		.text_bytes = (uint32_t)strlen(text),
	};
	memcpy(packet, &header, sizeof(header));
	memcpy(packet + sizeof(header), text, strlen(text));
	if (raw_send(socket, packet, header.header.size, &fd, fd >= 0) < 0 || !raw_receive(socket, reply) ||
		reply->header.type != PURSUIT_MESSAGE_CONTROL_REPLY)
		return -1;
	reply->raw[reply->bytes] = 0;
	return (int)reply->control.status;
}

int raw_memfd(uint64_t bytes, int seals)
{
	const int fd = memfd_create("pursuit-test", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	if (fd < 0 || ftruncate(fd, (off_t)bytes) < 0 || (seals && fcntl(fd, F_ADD_SEALS, seals) < 0)) {
		perror("memfd");
		exit(1);
	}
	return fd;
}

void raw_stream_init(struct raw_stream *stream, int socket, uint64_t stream_id)
{
	memset(stream, 0, sizeof(*stream));
	stream->socket = socket;
	stream->stream_id = stream_id;
	stream->wake_fd = -1;
	stream->control_fd = raw_memfd(sizeof(*stream->control), RAW_ALL_SEALS);
	stream->planes_fd = raw_memfd(RAW_SLOTS * RAW_SLOT_BYTES, RAW_ALL_SEALS);
	stream->control = mmap(NULL, sizeof(*stream->control), PROT_READ | PROT_WRITE, MAP_SHARED, stream->control_fd, 0);
	stream->planes = mmap(NULL, RAW_SLOTS * RAW_SLOT_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, stream->planes_fd, 0);
	if (stream->control == MAP_FAILED || stream->planes == MAP_FAILED) {
		perror("mmap");
		exit(1);
	}
	stream->control->magic = PURSUIT_SHM_MAGIC;
	stream->control->version = PURSUIT_SHM_VERSION;
	stream->control->slot_count = RAW_SLOTS;
	stream->control->slot_bytes = RAW_SLOT_BYTES;
	stream->control->latest = 1;
	stream->own_slot = 2;
	stream->next_id = 1;
}

bool raw_stream_open(struct raw_stream *stream, struct raw_reply *reply)
{
	const struct pursuit_message_open_stream open = raw_open(stream->stream_id, RAW_SLOTS, RAW_SLOT_BYTES);
	const int fds[2] = {stream->control_fd, stream->planes_fd};
	if (raw_send(stream->socket, &open, sizeof(open), fds, 2) < 0 || !raw_receive(stream->socket, reply) ||
		reply->header.type != PURSUIT_MESSAGE_STREAM_OPENED || reply->fd_count != 1)
		return false;
	stream->wake_fd = reply->fds[0];
	return true;
}

void raw_stream_finish(struct raw_stream *stream)
{
	munmap(stream->control, sizeof(*stream->control));
	munmap(stream->planes, RAW_SLOTS * RAW_SLOT_BYTES);
	close(stream->control_fd);
	close(stream->planes_fd);
	if (stream->wake_fd >= 0)
		close(stream->wake_fd);
}

static uint8_t *slot_of(const struct raw_stream *stream)
{
	return stream->planes + stream->own_slot * RAW_SLOT_BYTES;
}

float *raw_depth(struct raw_stream *stream)
{
	return (float *)(void *)(slot_of(stream) + DEPTH_OFFSET);
}

float *raw_motion(struct raw_stream *stream)
{
	return (float *)(void *)(slot_of(stream) + MOTION_OFFSET);
}

static struct pursuit_plane plane_of(uint32_t role, uint32_t format, uint64_t offset, uint32_t bytes)
{
	return (struct pursuit_plane){
		.role = role,
		.format = format,
		.storage = PURSUIT_STORAGE_MEMORY,
		.width = RAW_WIDTH,
		.height = RAW_HEIGHT,
		.offset = offset,
		.stride = (uint64_t)RAW_WIDTH * bytes,
		.size = (uint64_t)RAW_WIDTH * RAW_HEIGHT * bytes,
	};
}

struct pursuit_frame_header *raw_fill(struct raw_stream *stream)
{
	struct pursuit_frame_header *header = &stream->control->headers[stream->own_slot];
	memset(header, 0, sizeof(*header));
	header->frame_id = stream->next_id++;
	header->time_ns = header->submit_ns = now_ns();
	header->real_interval_ns = 16666667;
	header->plane_count = 3;
	header->motion_kind = PURSUIT_MOTION_BACKWARD;
	header->depth_kind = PURSUIT_DEPTH_DEVICE;
	header->planes[0] = plane_of(PURSUIT_ROLE_COLOR, PURSUIT_FORMAT_BGRA8, 0, 4);
	header->planes[0].transfer.curve = PURSUIT_CURVE_SRGB;
	header->planes[1] = plane_of(PURSUIT_ROLE_DEPTH, PURSUIT_FORMAT_DEPTH32F, DEPTH_OFFSET, 4);
	header->planes[2] = plane_of(PURSUIT_ROLE_MOTION, PURSUIT_FORMAT_RG32F, MOTION_OFFSET, 8);
	memset(slot_of(stream), (int)(header->frame_id * 7 & 0xff), DEPTH_OFFSET);
	for (uint32_t i = 0; i < RAW_WIDTH * RAW_HEIGHT; i++) {
		raw_depth(stream)[i] = i % RAW_WIDTH < RAW_WIDTH / 2 ? 0.25f : 0.75f;
		raw_motion(stream)[2 * i] = i % RAW_WIDTH < RAW_WIDTH / 2 ? 4.0f : 0.0f;
		raw_motion(stream)[2 * i + 1] = 0.0f;
	}
	return header;
}

void raw_publish(struct raw_stream *stream)
{
	const uint64_t one = 1;
	const uint32_t before =
		__atomic_exchange_n(&stream->control->latest, stream->own_slot | PURSUIT_SLOT_FRESH, __ATOMIC_ACQ_REL);
	stream->own_slot = before & PURSUIT_SLOT_INDEX_MASK;
	if (write(stream->wake_fd, &one, sizeof(one)) < 0)
		perror("eventfd");
}

bool raw_feedback(struct raw_stream *stream, struct pursuit_feedback *report)
{
	const uint64_t n = stream->feedback_read;
	struct pursuit_feedback *entry = &stream->control->feedback[n % PURSUIT_FEEDBACK_ENTRIES];
	for (unsigned waited = 0; waited < PATIENCE_MS; waited += 2) {
		if (__atomic_load_n(&entry->sequence, __ATOMIC_ACQUIRE) >= 2 * n + 2) {
			memcpy(report, entry, sizeof(*report));
			stream->feedback_read++;
			return true;
		}
		sleep_ms(2);
	}
	return false;
}
