/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/client/fake_daemon.h"

#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#define MANY_FDS 40

bool fake_start(struct fake_daemon *daemon, const char *path, enum fake_manner manner)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};

	memset(daemon, 0, sizeof(*daemon));
	daemon->manner = manner;
	daemon->client = -1;
	daemon->wake = -1;
	snprintf(daemon->path, sizeof(daemon->path), "%s", path);
	memcpy(address.sun_path, daemon->path, sizeof(daemon->path));
	unlink(path);
	daemon->listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	if (bind(daemon->listener, (struct sockaddr *)&address, sizeof(address)) < 0 ||
		listen(daemon->listener, manner == FAKE_NOT_ACCEPTING ? 0 : 8) < 0) {
		perror(path);
		return false;
	}
	return true;
}

static void drop_client(struct fake_daemon *daemon)
{
	if (daemon->control) {
		munmap(daemon->control, sizeof(*daemon->control));
		munmap((void *)(uintptr_t)daemon->planes, daemon->planes_bytes);
		daemon->control = NULL;
	}
	if (daemon->wake >= 0) {
		close(daemon->wake);
		daemon->wake = -1;
	}
	if (daemon->client >= 0) {
		close(daemon->client);
		daemon->client = -1;
	}
}

void fake_stop(struct fake_daemon *daemon, bool unlink_path)
{
	drop_client(daemon);
	close(daemon->listener);
	if (unlink_path) {
		unlink(daemon->path);
	}
}

static void send_packet(struct fake_daemon *daemon, const void *bytes, size_t size, const int *fds, size_t fd_count)
{
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(sizeof(int) * MANY_FDS)];
	} control = {0};
	struct iovec vector = {.iov_base = (void *)(uintptr_t)bytes, .iov_len = size};
	struct msghdr message = {.msg_iov = &vector, .msg_iovlen = 1};

	if (fd_count) {
		message.msg_control = &control;
		message.msg_controllen = CMSG_SPACE(sizeof(int) * fd_count);
		struct cmsghdr *rights = CMSG_FIRSTHDR(&message);
		rights->cmsg_level = SOL_SOCKET;
		rights->cmsg_type = SCM_RIGHTS;
		rights->cmsg_len = CMSG_LEN(sizeof(int) * fd_count);
		memcpy(CMSG_DATA(rights), fds, sizeof(int) * fd_count);
	}
	sendmsg(daemon->client, &message, MSG_DONTWAIT | MSG_NOSIGNAL);
}

static void send_refused(struct fake_daemon *daemon, uint32_t code, uint32_t fatal, const char *text)
{
	struct pursuit_message_refused refused = {
		.header = {.type = PURSUIT_MESSAGE_REFUSED, .size = sizeof(refused)},
		.code = code,
		.fatal = fatal,
	};

	snprintf(refused.text, sizeof(refused.text), "%s", text);
	send_packet(daemon, &refused, sizeof(refused), NULL, 0);
}

static void answer_hello(struct fake_daemon *daemon, const struct pursuit_message_hello *hello)
{
	struct pursuit_message_welcome welcome = {
		.header = {.type = PURSUIT_MESSAGE_WELCOME, .size = sizeof(welcome), .serial = hello->header.serial},
		.version = daemon->manner == FAKE_WRONG_VERSION ? 9 : 1,
		.max_width = PURSUIT_MAX_SIZE,
		.max_height = PURSUIT_MAX_SIZE,
		.max_streams = 1,
		.max_slots = PURSUIT_MAX_SLOTS,
		.max_slot_bytes = PURSUIT_MAX_FRAME_BYTES,
		.name = "fake",
	};
	uint8_t large[4096] = {0};

	memcpy(daemon->client_name, hello->name, sizeof(daemon->client_name));
	switch (daemon->manner) {
	case FAKE_REFUSES_VERSION:
		send_refused(daemon, PURSUIT_REFUSED_VERSION, 1, "version 1 is \x1b[31mtoo old");
		drop_client(daemon);
		return;
	case FAKE_SHORT_PACKET:
		send_packet(daemon, &welcome, 7, NULL, 0);
		return;
	case FAKE_LONG_PACKET:
		/* Cut to what the client can hold, it would be a good REFUSED. */
		welcome.header.type = PURSUIT_MESSAGE_REFUSED;
		welcome.header.size = sizeof(struct pursuit_message_refused);
		memcpy(large, &welcome, sizeof(welcome));
		send_packet(daemon, large, sizeof(large), NULL, 0);
		return;
	case FAKE_EMPTY_PACKET:
		send_packet(daemon, &welcome, 0, NULL, 0);
		return;
	case FAKE_UNKNOWN_TYPE:
		welcome.header.type = 77;
		break;
	case FAKE_LYING_SIZE:
		welcome.header.size = 16;
		break;
	case FAKE_FDS_WITH_WELCOME:
		send_packet(daemon, &welcome, sizeof(welcome), (const int[]){0, 1}, 2);
		return;
	case FAKE_OPENED_FIRST:
		return;
	case FAKE_TWO_WELCOMES:
		send_packet(daemon, &welcome, sizeof(welcome), NULL, 0);
		break;
	default:
		break;
	}
	send_packet(daemon, &welcome, sizeof(welcome), NULL, 0);
}

/* The file that the client is told to write to, good or not. */
static int make_wake(enum fake_manner manner)
{
	int pair[2];

	switch (manner) {
	case FAKE_PIPE_FOR_WAKE:
		if (pipe(pair) < 0) {
			return -1;
		}
		close(pair[0]);
		return pair[1];
	case FAKE_SOCKET_FOR_WAKE:
		if (socketpair(AF_UNIX, SOCK_STREAM, 0, pair) < 0) {
			return -1;
		}
		close(pair[0]);
		return pair[1];
	case FAKE_FILE_FOR_WAKE:
		return open("/dev/null", O_RDWR | O_CLOEXEC);
	case FAKE_BLOCKING_FULL_WAKE:
		return eventfd(0, EFD_CLOEXEC);
	default:
		return eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	}
}

static void answer_open(struct fake_daemon *daemon, const struct pursuit_message_open_stream *open)
{
	struct pursuit_message_stream_opened opened = {
		.header = {.type = PURSUIT_MESSAGE_STREAM_OPENED, .size = sizeof(opened), .serial = open->header.serial},
		.stream_id = daemon->manner == FAKE_OTHER_STREAM ? open->stream_id + 1 : open->stream_id,
		.refresh_numerator = 120000,
		.refresh_denominator = 1001,
	};
	size_t count = daemon->manner == FAKE_MANY_FDS ? MANY_FDS : daemon->manner == FAKE_NO_FD ? 0 : 1;
	int fds[MANY_FDS];

	if (daemon->manner == FAKE_REFUSES_STREAM) {
		send_refused(daemon, PURSUIT_REFUSED_LIMIT, 0, "too many streams");
		return;
	}
	daemon->wake = make_wake(daemon->manner);
	for (int i = 0; i < MANY_FDS; i++) {
		fds[i] = daemon->wake;
	}
	send_packet(daemon, &opened, sizeof(opened), fds, count);
}

static bool is_sealed(int fd, int64_t bytes)
{
	struct stat status;
	int seals = fcntl(fd, F_GET_SEALS);
	int wanted = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;

	return seals >= 0 && (seals & wanted) == wanted && fstat(fd, &status) == 0 && status.st_size == bytes &&
		   (fcntl(fd, F_GETFD) & FD_CLOEXEC);
}

static void open_stream(struct fake_daemon *daemon, const struct pursuit_message_open_stream *open, const int *fds)
{
	daemon->slot_count = open->slot_count;
	daemon->slot_bytes = (uint32_t)open->slot_bytes;
	daemon->planes_bytes = open->slot_bytes * open->slot_count;
	daemon->bad_offer = !is_sealed(fds[0], sizeof(struct pursuit_shm_control)) ||
						!is_sealed(fds[1], (int64_t)daemon->planes_bytes) || open->stream_id == 0 ||
						open->slot_bytes % 4096 || open->flags;
	daemon->control = mmap(NULL, sizeof(*daemon->control), PROT_READ | PROT_WRITE, MAP_SHARED, fds[0], 0);
	daemon->planes = mmap(NULL, daemon->planes_bytes, PROT_READ, MAP_SHARED, fds[1], 0);
	if (daemon->control == MAP_FAILED || daemon->planes == MAP_FAILED) {
		perror("mmap");
		exit(1);
	}
	daemon->bad_offer |= daemon->control->magic != PURSUIT_SHM_MAGIC || daemon->control->version != 1 ||
						 daemon->control->slot_count != open->slot_count ||
						 daemon->control->slot_bytes != open->slot_bytes || daemon->control->latest != 1;
	daemon->held = 0;
	answer_open(daemon, open);
}

static void read_packet(struct fake_daemon *daemon)
{
	union {
		struct pursuit_message header;
		struct pursuit_message_hello hello;
		struct pursuit_message_open_stream open;
	} packet;
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(sizeof(int) * 2)];
	} control;
	struct iovec vector = {.iov_base = &packet, .iov_len = sizeof(packet)};
	struct msghdr message = {
		.msg_iov = &vector, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof(control)};
	int fds[2] = {-1, -1};
	ssize_t got = recvmsg(daemon->client, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
	struct cmsghdr *rights = got > 0 ? CMSG_FIRSTHDR(&message) : NULL;

	if (got == 0) {
		drop_client(daemon);
	}
	if (got <= 0) {
		return;
	}
	if (rights && rights->cmsg_len == CMSG_LEN(sizeof(fds))) {
		memcpy(fds, CMSG_DATA(rights), sizeof(fds));
	}
	if (packet.header.type == PURSUIT_MESSAGE_HELLO && got == sizeof(packet.hello)) {
		answer_hello(daemon, &packet.hello);
	} else if (packet.header.type == PURSUIT_MESSAGE_OPEN_STREAM && got == sizeof(packet.open) && fds[1] >= 0) {
		open_stream(daemon, &packet.open, fds);
	} else {
		daemon->bad_offer = true;
	}
	close(fds[0]);
	close(fds[1]);
}

void fake_step(struct fake_daemon *daemon)
{
	if (daemon->manner == FAKE_NOT_ACCEPTING) {
		return;
	}
	int next = accept4(daemon->listener, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
	if (next >= 0) {
		drop_client(daemon);
		daemon->client = next;
		daemon->accepts++;
	}
	if (daemon->manner == FAKE_SILENT) {
		return;
	}
	/* HELLO and OPEN_STREAM may lie there together. */
	for (int i = 0; i < 3 && daemon->client >= 0; i++) {
		read_packet(daemon);
	}
	for (int i = 0; i < 1000 && daemon->manner == FAKE_FLOOD && daemon->client >= 0; i++) {
		send_refused(daemon, PURSUIT_REFUSED_FRAME, 0, "flood");
	}
}

const struct pursuit_frame_header *fake_take(struct fake_daemon *daemon, const uint8_t **planes)
{
	if (!daemon->control || !(__atomic_load_n(&daemon->control->latest, __ATOMIC_RELAXED) & PURSUIT_SLOT_FRESH)) {
		return NULL;
	}
	uint32_t got = __atomic_exchange_n(&daemon->control->latest, daemon->held, __ATOMIC_ACQ_REL);
	daemon->held = got & PURSUIT_SLOT_INDEX_MASK;
	if (planes) {
		*planes = daemon->planes + (uint64_t)daemon->held * daemon->slot_bytes;
	}
	return &daemon->control->headers[daemon->held];
}

void fake_report(struct fake_daemon *daemon, uint64_t frame_id, uint32_t state)
{
	uint64_t number = daemon->control->feedback_count;
	struct pursuit_feedback *entry = &daemon->control->feedback[number % PURSUIT_FEEDBACK_ENTRIES];

	__atomic_store_n(&entry->sequence, 2 * number + 1, __ATOMIC_RELAXED);
	__atomic_thread_fence(__ATOMIC_RELEASE);
	entry->frame_id = frame_id;
	entry->flip_ns = 1000 + frame_id;
	entry->state = state;
	__atomic_store_n(&entry->sequence, 2 * number + 2, __ATOMIC_RELEASE);
	__atomic_store_n(&daemon->control->feedback_count, number + 1, __ATOMIC_RELEASE);
}

void fake_close_stream(struct fake_daemon *daemon, const char *why)
{
	struct pursuit_message_close_stream closed = {
		.header = {.type = PURSUIT_MESSAGE_STREAM_CLOSED, .size = sizeof(closed)},
		.stream_id = 1,
	};

	if (why) {
		send_refused(daemon, PURSUIT_REFUSED_FRAME, 0, why);
	}
	send_packet(daemon, &closed, sizeof(closed), NULL, 0);
}

void fake_say_shutdown(struct fake_daemon *daemon)
{
	send_refused(daemon, PURSUIT_REFUSED_SHUTDOWN, 1, "the daemon is stopping");
}

uint64_t fake_wakes(struct fake_daemon *daemon)
{
	uint64_t value = 0;
	return read(daemon->wake, &value, sizeof(value)) == (ssize_t)sizeof(value) ? value : 0;
}

static void run_forever(const char *path, int ready)
{
	struct fake_daemon daemon;
	const struct pursuit_frame_header *header;

	if (!fake_start(&daemon, path, FAKE_GOOD) || write(ready, "", 1) != 1) {
		_exit(1);
	}
	for (;;) {
		struct pollfd fds[2] = {{.fd = daemon.listener, .events = POLLIN}, {.fd = daemon.client, .events = POLLIN}};
		poll(fds, 2, 1);
		fake_step(&daemon);
		while ((header = fake_take(&daemon, NULL)) != NULL) {
			fake_report(&daemon, header->frame_id, PURSUIT_FEEDBACK_SHOWN);
		}
	}
}

pid_t fake_fork(const char *path)
{
	int ready[2];
	char byte;

	if (pipe2(ready, O_CLOEXEC) < 0) {
		return -1;
	}
	pid_t child = fork();
	if (child == 0) {
		run_forever(path, ready[1]);
	}
	close(ready[1]);
	ssize_t got = read(ready[0], &byte, 1);
	close(ready[0]);
	return got == 1 ? child : -1;
}
