/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/fuzz/talker.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "proto/wire.h"
#include "tests/fuzz/good-frame.h"

#define SLOTS 4u
#define SEALS (F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL)
#define MOST_FDS 12

void talker_init(struct talker *talker)
{
	*talker = (struct talker){-1, -1, -1, -1, NULL};
}

static void close_fd(int *fd)
{
	if (*fd >= 0)
		close(*fd);
	*fd = -1;
}

static void drop_memory(struct talker *talker)
{
	if (talker->control)
		munmap(talker->control, sizeof(*talker->control));
	talker->control = NULL;
	close_fd(&talker->control_fd);
	close_fd(&talker->planes_fd);
	close_fd(&talker->wake_fd);
}

void talker_finish(struct talker *talker)
{
	drop_memory(talker);
	close_fd(&talker->socket);
}

void talker_connect(struct talker *talker, const char *path)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	talker->socket = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	snprintf(address.sun_path, sizeof(address.sun_path), "%s", path);
	if (connect(talker->socket, (struct sockaddr *)&address, sizeof(address)) < 0)
		close_fd(&talker->socket);
}

/* ---- sending ---- */

static void send_packet(struct talker *talker, const void *bytes, size_t size, const int *fds, size_t fd_count)
{
	char control[CMSG_SPACE(MOST_FDS * sizeof(int))] __attribute__((aligned(16))) = {0};
	struct iovec part = {(void *)(uintptr_t)bytes, size};
	struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
	if (fd_count > 0) {
		message.msg_control = control;
		message.msg_controllen = CMSG_SPACE(fd_count * sizeof(int));
		struct cmsghdr *rights = CMSG_FIRSTHDR(&message);
		rights->cmsg_level = SOL_SOCKET;
		rights->cmsg_type = SCM_RIGHTS;
		rights->cmsg_len = CMSG_LEN(fd_count * sizeof(int));
		memcpy(CMSG_DATA(rights), fds, fd_count * sizeof(int));
	}
	if (talker->socket >= 0 && sendmsg(talker->socket, &message, MSG_NOSIGNAL | MSG_DONTWAIT) < 0 && errno == EPIPE)
		close_fd(&talker->socket);
}

void talker_greet(struct talker *talker)
{
	const struct pursuit_message_hello hello = {
		.header = {.type = PURSUIT_MESSAGE_HELLO, .size = sizeof(hello), .serial = 1},
		.magic = PURSUIT_WIRE_MAGIC,
		.version_min = PURSUIT_WIRE_VERSION_MIN,
		.version_max = PURSUIT_WIRE_VERSION_MAX,
		.name = "fuzz",
	};
	send_packet(talker, &hello, sizeof(hello), NULL, 0);
}

/* A file of one of the kinds that a client could send. */
static int make_fd(uint8_t kind)
{
	int ends[2];
	int fd;
	switch (kind % 8) {
	case 0:
		return open("/dev/null", O_RDWR | O_CLOEXEC);
	case 1:
		return eventfd(0, EFD_CLOEXEC);
	case 2:
		fd = pipe2(ends, O_CLOEXEC) == 0 ? ends[0] : -1;
		if (fd >= 0)
			close(ends[1]);
		return fd;
	case 3:
		return open("/", O_RDONLY | O_CLOEXEC);
	case 4:
		return socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	case 5:
		return open("/proc/self/stat", O_RDONLY | O_CLOEXEC);
	default:
		fd = memfd_create("fuzz", MFD_CLOEXEC | MFD_ALLOW_SEALING);
		if (fd >= 0 && kind & 0x80 && ftruncate(fd, (kind & 0x40 ? 1 : 16) * 4096) == 0 && kind & 0x20)
			fcntl(fd, F_ADD_SEALS, kind & 0x10 ? SEALS : F_SEAL_GROW);
		return fd;
	}
}

static void close_fds(int *fds, size_t count)
{
	while (count > 0)
		close_fd(&fds[--count]);
}

/* A packet as it stands in the input, its size put right or not, with files of any kind. */
static void send_anything(struct talker *talker, struct fuzz_input *input, uint32_t type)
{
	uint8_t packet[512] = {0};
	int fds[MOST_FDS];
	size_t taken;
	const uint8_t choices = fuzz_u8(input), fd_count = fuzz_u8(input) % MOST_FDS;
	for (size_t i = 0; i < fd_count; i++)
		fds[i] = make_fd(fuzz_u8(input));
	const size_t most = fuzz_u8(input) * 2u;
	const uint8_t *from = fuzz_bytes(input, most, &taken);
	memcpy(packet, from, taken);
	struct pursuit_message header = {.type = type, .size = (uint32_t)taken, .serial = choices};
	if (choices & 1 && taken >= sizeof(header))
		memcpy(packet, &header, sizeof(header));
	if (taken > 0 || choices & 2)
		send_packet(talker, packet, taken, fds, fds[0] < 0 ? 0 : fd_count);
	close_fds(fds, fd_count);
}

static void send_hello(struct talker *talker, struct fuzz_input *input)
{
	size_t taken;
	struct pursuit_message_hello hello = {
		.header = {.type = PURSUIT_MESSAGE_HELLO, .size = sizeof(hello)},
		.magic = PURSUIT_WIRE_MAGIC ^ fuzz_u8(input),
		.version_min = fuzz_u8(input),
		.version_max = fuzz_u8(input),
		.reserved = fuzz_u8(input),
	};
	const uint8_t *name = fuzz_bytes(input, fuzz_u8(input) % (sizeof(hello.name) + 1), &taken);
	memcpy(hello.name, name, taken);
	send_packet(talker, &hello, sizeof(hello), NULL, 0);
}

/* ---- streams ---- */

static int sealed_memfd(uint64_t bytes, int seals)
{
	const int fd = memfd_create("fuzz", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	FUZZ_EXPECT(fd >= 0 && ftruncate(fd, (off_t)bytes) == 0);
	if (seals)
		FUZZ_EXPECT(fcntl(fd, F_ADD_SEALS, seals) == 0);
	return fd;
}

/* Good memory, or with one thing wrong by the choices. */
static void make_memory(struct talker *talker, uint8_t choices)
{
	drop_memory(talker);
	talker->control_fd = sealed_memfd(choices & 1 ? 4096 : sizeof(*talker->control), choices & 2 ? 0 : SEALS);
	talker->planes_fd = sealed_memfd(SLOTS * GOOD_FRAME_BYTES, choices & 4 ? F_SEAL_SHRINK : SEALS);
	if (choices & 1)
		return;
	talker->control = mmap(NULL, sizeof(*talker->control), PROT_READ | PROT_WRITE, MAP_SHARED, talker->control_fd, 0);
	FUZZ_EXPECT(talker->control != MAP_FAILED);
	talker->control->magic = PURSUIT_SHM_MAGIC;
	talker->control->version = PURSUIT_SHM_VERSION + (choices >> 7);
	talker->control->slot_count = SLOTS;
	talker->control->slot_bytes = GOOD_FRAME_BYTES;
	talker->control->latest = 1;
}

static void open_stream(struct talker *talker, struct fuzz_input *input)
{
	const uint8_t choices = fuzz_u8(input);
	struct pursuit_message_open_stream open = {
		.header = {.type = PURSUIT_MESSAGE_OPEN_STREAM, .size = sizeof(open), .serial = 2},
		.stream_id = fuzz_u8(input) % 8,
		.slot_count = SLOTS,
		.slot_bytes = GOOD_FRAME_BYTES,
	};
	if (choices & 8)
		open.slot_count = (uint32_t)fuzz_number(input);
	if (choices & 16)
		open.slot_bytes = fuzz_number(input);
	if (choices & 32)
		open.flags = fuzz_u8(input);
	if (choices & 64)
		open.reserved[choices % 3] = fuzz_u8(input);
	make_memory(talker, choices);
	const int fds[2] = {talker->control_fd, talker->planes_fd};
	send_packet(talker, &open, sizeof(open), fds, 2);
}

static void close_stream(struct talker *talker, struct fuzz_input *input)
{
	const struct pursuit_message_close_stream message = {
		.header = {.type = PURSUIT_MESSAGE_CLOSE_STREAM, .size = sizeof(message), .serial = 3},
		.stream_id = fuzz_u8(input) % 8,
		.reserved = fuzz_u8(input) & 1,
	};
	send_packet(talker, &message, sizeof(message), NULL, 0);
}

static void publish(struct talker *talker, struct fuzz_input *input)
{
	const uint64_t one = 1;
	const uint8_t slot = fuzz_u8(input);
	if (!talker->control)
		return;
	struct pursuit_frame_header *header = &talker->control->headers[slot % SLOTS];
	good_frame(header);
	good_frame_patch(header, input, slot >> 5);
	__atomic_exchange_n(&talker->control->latest, (slot & 7u) | PURSUIT_SLOT_FRESH, __ATOMIC_ACQ_REL);
	if (talker->wake_fd >= 0)
		FUZZ_EXPECT(write(talker->wake_fd, &one, sizeof(one)) == (ssize_t)sizeof(one));
}

/* ---- requests ---- */

static void send_request(struct talker *talker, struct fuzz_input *input)
{
	static const char *const known[] = {
		"status",       "settings",     "timeline 0 5", "timeline", "record", "record-stop",
		"timeline x y", "timeline 1 9", "ping",         "record x", "",       "pingpong"};
	static const char *const changing[] = {"set cell=9", "set cell=9 blur=x", "unset cell", "unset", "reload", "set"};
	struct {
		struct pursuit_message_control header;
		char text[256];
	} packet = {.header = {.header = {.type = PURSUIT_MESSAGE_CONTROL, .serial = 4}}};
	const uint8_t choice = fuzz_u8(input), fd_kind = fuzz_u8(input);
	size_t length;
	if (choice < 128) {
		const char *text = choice < 116 ? known[choice % 12] : changing[choice % 6];
		length = strlen(text);
		memcpy(packet.text, text, length);
	} else {
		const uint8_t *text = fuzz_bytes(input, fuzz_u8(input), &length);
		memcpy(packet.text, text, length);
	}
	packet.header.text_bytes = (uint32_t)length;
	packet.header.header.size = (uint32_t)(sizeof(packet.header) + length);
	int fd = fd_kind & 1 ? make_fd(fd_kind >> 1 | 0x80) : -1;
	send_packet(talker, &packet, packet.header.header.size, &fd, fd >= 0);
	close_fd(&fd);
}

/* ---- answers ---- */

/* Whatever was said, what comes back is of a known shape. */
static void check_answer(const uint8_t *packet, size_t bytes)
{
	struct pursuit_message header;
	struct pursuit_message_refused refused;
	FUZZ_EXPECT(bytes >= sizeof(header));
	memcpy(&header, packet, sizeof(header));
	FUZZ_EXPECT(header.size == bytes && header.reserved == 0);
	switch (header.type) {
	case PURSUIT_MESSAGE_WELCOME:
		FUZZ_EXPECT(bytes == sizeof(struct pursuit_message_welcome));
		return;
	case PURSUIT_MESSAGE_REFUSED:
		FUZZ_EXPECT(bytes == sizeof(refused));
		memcpy(&refused, packet, sizeof(refused));
		FUZZ_EXPECT(refused.code >= 1 && refused.code <= 9 && refused.fatal <= 1);
		FUZZ_EXPECT(memchr(refused.field, 0, sizeof(refused.field)) && memchr(refused.text, 0, sizeof(refused.text)));
		return;
	case PURSUIT_MESSAGE_STREAM_OPENED:
		FUZZ_EXPECT(bytes == sizeof(struct pursuit_message_stream_opened));
		return;
	case PURSUIT_MESSAGE_STREAM_CLOSED:
		FUZZ_EXPECT(bytes == sizeof(struct pursuit_message_close_stream));
		return;
	default:
		FUZZ_EXPECT(header.type == PURSUIT_MESSAGE_CONTROL_REPLY);
		FUZZ_EXPECT(bytes >= sizeof(struct pursuit_message_control));
	}
}

static void read_answers(struct talker *talker)
{
	static uint8_t packet[PURSUIT_WIRE_MAX_PACKET + 1];
	char control[CMSG_SPACE(sizeof(int))] __attribute__((aligned(16)));
	struct iovec part = {packet, sizeof(packet)};
	while (talker->socket >= 0) {
		struct msghdr message = {
			.msg_iov = &part, .msg_iovlen = 1, .msg_control = control, .msg_controllen = sizeof(control)};
		const ssize_t got = recvmsg(talker->socket, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
		if (got < 0 && errno == EAGAIN)
			return;
		if (got <= 0) {
			close_fd(&talker->socket);
			return;
		}
		check_answer(packet, (size_t)got);
		const struct cmsghdr *rights = CMSG_FIRSTHDR(&message);
		if (!rights)
			continue;
		close_fd(&talker->wake_fd);
		memcpy(&talker->wake_fd, CMSG_DATA(rights), sizeof(talker->wake_fd));
	}
}

void talker_act(struct talker *talker, struct fuzz_input *input)
{
	const uint8_t what = fuzz_u8(input);
	switch (what % 10) {
	case 0:
		send_hello(talker, input);
		return;
	case 1:
		send_anything(talker, input, what / 10 % 11);
		return;
	case 2:
	case 3:
		open_stream(talker, input);
		return;
	case 4:
		close_stream(talker, input);
		return;
	case 5:
	case 6:
		publish(talker, input);
		return;
	case 7:
		if (talker->control)
			((volatile uint32_t *)(void *)talker->control)[fuzz_u16(input) % 4096] = (uint32_t)fuzz_number(input);
		return;
	case 8:
		read_answers(talker);
		return;
	default:
		send_request(talker, input);
	}
}
