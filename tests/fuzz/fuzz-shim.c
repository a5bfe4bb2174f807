/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The client's shim against a daemon that says and writes anything. Input:
 * steps of the game (acquire, submit, cancel, poll), of the clock, and of the
 * daemon (accept, packets good and bad with any files, the slot word, the
 * feedback ring, hanging up). Time is the fuzzer's: clock_gettime() is wrapped.
 */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "client/pursuit.h"
#include "proto/shm.h"
#include "proto/wire.h"
#include "tests/fuzz/fuzz.h"

#define MOST_STEPS 64
#define MOST_FRAMES 6

static uint64_t now_ns;

int __wrap_clock_gettime(clockid_t clock, struct timespec *time);

int __wrap_clock_gettime(clockid_t clock, struct timespec *time)
{
	(void)clock;
	*time = (struct timespec){(time_t)(now_ns / 1000000000), (long)(now_ns % 1000000000)};
	return 0;
}

struct stage {
	char path[64];
	int listener, socket;
	struct pursuit_shm_control *control; /* of the stream that was offered last, NULL none */
	struct pursuit_stream *stream;
	struct pursuit_frame *frames[MOST_FRAMES];
};

/* ---- the daemon's side ---- */

static void hang_up(struct stage *stage)
{
	if (stage->socket >= 0)
		close(stage->socket);
	if (stage->control)
		munmap(stage->control, sizeof(*stage->control));
	stage->socket = -1;
	stage->control = NULL;
}

static void listen_at(struct stage *stage)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	snprintf(stage->path, sizeof(stage->path), "/tmp/pursuit-fuzz-shim-%d", (int)getpid());
	snprintf(address.sun_path, sizeof(address.sun_path), "%s", stage->path);
	unlink(stage->path);
	stage->listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	FUZZ_EXPECT(bind(stage->listener, (struct sockaddr *)&address, sizeof(address)) == 0);
	FUZZ_EXPECT(listen(stage->listener, 8) == 0);
}

static void accept_one(struct stage *stage)
{
	hang_up(stage);
	stage->socket = accept4(stage->listener, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
}

/* Reads what the shim said; the control page that came with it is mapped. */
static void read_offer(struct stage *stage)
{
	char control[CMSG_SPACE(2 * sizeof(int))] __attribute__((aligned(16)));
	uint8_t packet[512];
	struct iovec part = {packet, sizeof(packet)};
	struct msghdr message = {
		.msg_iov = &part, .msg_iovlen = 1, .msg_control = control, .msg_controllen = sizeof(control)};
	if (stage->socket < 0 || recvmsg(stage->socket, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC) <= 0)
		return;
	const struct cmsghdr *rights = CMSG_FIRSTHDR(&message);
	if (!rights)
		return;
	int fds[2];
	memcpy(fds, CMSG_DATA(rights), sizeof(fds));
	if (stage->control)
		munmap(stage->control, sizeof(*stage->control));
	stage->control = mmap(NULL, sizeof(*stage->control), PROT_READ | PROT_WRITE, MAP_SHARED, fds[0], 0);
	FUZZ_EXPECT(stage->control != MAP_FAILED);
	close(fds[0]);
	close(fds[1]);
}

static void say(struct stage *stage, const void *bytes, size_t size, int fd)
{
	char control[CMSG_SPACE(sizeof(int))] __attribute__((aligned(16))) = {0};
	struct iovec part = {(void *)(uintptr_t)bytes, size};
	struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
	if (fd >= 0) {
		message.msg_control = control;
		message.msg_controllen = sizeof(control);
		struct cmsghdr *rights = CMSG_FIRSTHDR(&message);
		rights->cmsg_level = SOL_SOCKET;
		rights->cmsg_type = SCM_RIGHTS;
		rights->cmsg_len = CMSG_LEN(sizeof(int));
		memcpy(CMSG_DATA(rights), &fd, sizeof(fd));
	}
	if (stage->socket >= 0)
		(void)!sendmsg(stage->socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL);
}

static int some_file(uint8_t kind)
{
	int ends[2];
	switch (kind % 6) {
	case 0:
		return -1;
	case 1:
		return open("/dev/null", O_RDWR | O_CLOEXEC);
	case 2:
		return socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0 && close(ends[1]) == 0 ? ends[0] : -1;
	case 3:
		return eventfd(UINT32_MAX, EFD_CLOEXEC | EFD_SEMAPHORE);
	default:
		return eventfd(0, EFD_CLOEXEC | (kind & 0x80 ? 0 : EFD_NONBLOCK));
	}
}

/* A good packet of a type that a daemon sends, bytes of the input written over it, cut or not. */
static void say_something(struct stage *stage, struct fuzz_input *input)
{
	union {
		struct pursuit_message header;
		struct pursuit_message_welcome welcome;
		struct pursuit_message_stream_opened opened;
		struct pursuit_message_close_stream closed;
		struct pursuit_message_refused refused;
		uint8_t raw[512];
	} packet = {.raw = {0}};
	const uint8_t what = fuzz_u8(input), patches = fuzz_u8(input);
	const struct {
		uint32_t type;
		size_t bytes;
	} kinds[] = {{PURSUIT_MESSAGE_WELCOME, sizeof(packet.welcome)},
				 {PURSUIT_MESSAGE_STREAM_OPENED, sizeof(packet.opened)},
				 {PURSUIT_MESSAGE_STREAM_CLOSED, sizeof(packet.closed)},
				 {PURSUIT_MESSAGE_REFUSED, sizeof(packet.refused)}};
	size_t bytes = kinds[what % 4].bytes;
	packet.header = (struct pursuit_message){.type = kinds[what % 4].type, .size = (uint32_t)bytes};
	if (what % 4 == 0)
		packet.welcome.version = PURSUIT_WIRE_VERSION_MAX;
	if (what % 4 == 1) {
		packet.opened.stream_id = 1;
		packet.opened.refresh_numerator = 120;
		packet.opened.refresh_denominator = 1;
	}
	if (what % 4 == 3)
		packet.refused.code = 1 + what / 16 % 8;
	for (int i = 0; i < patches % 4; i++)
		packet.raw[fuzz_u16(input) % 512] = fuzz_u8(input);
	if (patches & 0x80)
		bytes = packet.header.size = fuzz_u16(input) % sizeof(packet);
	const int fd = what % 4 == 1 ? some_file(patches & 0x40 ? fuzz_u8(input) : 4) : some_file(patches >> 2 & 1);
	say(stage, &packet, bytes, fd);
	if (fd >= 0)
		close(fd);
}

static void scribble(struct stage *stage, struct fuzz_input *input)
{
	const uint16_t where = fuzz_u16(input);
	const uint64_t value = fuzz_number(input);
	if (!stage->control)
		return;
	if (where & 1)
		((volatile uint32_t *)(void *)stage->control)[where / 2 % 4096] = (uint32_t)value;
	else
		__atomic_store_n(&stage->control->latest, (uint32_t)value, __ATOMIC_RELEASE);
}

/* A report, whole or half written. */
static void report(struct stage *stage, struct fuzz_input *input)
{
	const uint8_t how = fuzz_u8(input);
	if (!stage->control)
		return;
	const uint64_t number = how & 1 ? fuzz_number(input) : stage->control->feedback_count;
	struct pursuit_feedback *entry = &stage->control->feedback[number % PURSUIT_FEEDBACK_ENTRIES];
	entry->sequence = 2 * number + (how & 2 ? 1 : 2);
	entry->state = how >> 4;
	entry->frame_id = number;
	stage->control->feedback_count = number + 1;
}

/* ---- the game's side ---- */

static void acquire(struct stage *stage)
{
	for (int i = 0; i < MOST_FRAMES; i++) {
		if (stage->frames[i])
			continue;
		struct pursuit_frame *frame = stage->frames[i] = pursuit_acquire(stage->stream);
		if (frame) {
			memset(frame->color.data, i, frame->color.stride * frame->color.height);
			memset(frame->depth.data, i, frame->depth.stride * frame->depth.height);
		}
		return;
	}
}

static void give(struct stage *stage, uint8_t which, bool submit)
{
	struct pursuit_frame **frame = &stage->frames[which % MOST_FRAMES];
	if (!*frame)
		return;
	if (submit)
		FUZZ_EXPECT(pursuit_submit(stage->stream, *frame) > 0);
	else
		pursuit_cancel(stage->stream, *frame);
	FUZZ_EXPECT(pursuit_submit(stage->stream, *frame) == 0); /* it is nobody's any more */
	*frame = NULL;
}

static void look(struct stage *stage)
{
	struct pursuit_feedback_report feedback;
	struct pursuit_status status;
	for (int i = 0; i < 100 && pursuit_poll_feedback(stage->stream, &feedback); i++)
		FUZZ_EXPECT(feedback.shown >= PURSUIT_SHOWN && feedback.shown <= PURSUIT_REFUSED);
	pursuit_get_status(stage->stream, &status);
	FUZZ_EXPECT(memchr(status.message, 0, sizeof(status.message)) != NULL);
	FUZZ_EXPECT(status.published <= status.submitted && status.replaced <= status.published);
	FUZZ_EXPECT(status.refresh_hz == 0.0 || (status.refresh_hz >= 1.0 && status.refresh_hz <= 10000.0));
}

static void do_step(struct stage *stage, struct fuzz_input *input)
{
	const uint8_t step = fuzz_u8(input);
	switch (step % 12) {
	case 0:
		acquire(stage);
		return;
	case 1:
		give(stage, step / 12, true);
		return;
	case 2:
		give(stage, step / 12, false);
		return;
	case 3:
		pursuit_update(stage->stream);
		return;
	case 4:
		look(stage);
		return;
	case 5:
		now_ns += (uint64_t)fuzz_u8(input) * 30000000;
		return;
	case 6:
		accept_one(stage);
		return;
	case 7:
		read_offer(stage);
		return;
	case 8:
		scribble(stage, input);
		return;
	case 9:
		report(stage, input);
		return;
	case 10:
		say_something(stage, input);
		return;
	default:
		if (step & 0x80)
			hang_up(stage);
		else
			say_something(stage, input);
	}
}

int fuzz_one(const uint8_t *data, size_t size)
{
	struct fuzz_input input = {data, size};
	struct stage stage = {.listener = -1, .socket = -1};
	const int open_fds = fuzz_open_fds();
	now_ns = 1000000000;
	listen_at(&stage);
	const struct pursuit_stream_params params = {
		.width = 8, .height = 8, .depth_format = PURSUIT_DEPTH_UNORM16, .socket_path = stage.path, .slot_count = 5};
	stage.stream = pursuit_open(&params);
	FUZZ_EXPECT(stage.stream != NULL);
	for (int i = 0; i < MOST_STEPS && input.size > 0; i++)
		do_step(&stage, &input);
	pursuit_close(&stage.stream);
	hang_up(&stage);
	close(stage.listener);
	unlink(stage.path);
	FUZZ_EXPECT(fuzz_open_fds() == open_fds);
	return 0;
}
