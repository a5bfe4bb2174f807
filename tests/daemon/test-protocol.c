/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Everything that a client can say wrong: each is refused with the field and
 * its value, no descriptor leaks, and another client is served all the while.
 */

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/daemon/fixture.h"
#include "tests/daemon/raw-client.h"

static struct fixture fixture;

/* ---- the other client ---- */

static struct {
	pthread_t thread;
	atomic_bool stop;
	uint64_t reports; /* atomic */
	atomic_bool failed;
} neighbour;

static void *be_served(void *data)
{
	struct raw_stream stream;
	struct raw_reply *reply = malloc(sizeof(*reply));
	const int fd = raw_greet(fixture.socket);
	(void)data;
	raw_stream_init(&stream, fd, 1);
	neighbour.failed = !raw_stream_open(&stream, reply);
	while (!neighbour.stop && !neighbour.failed) {
		raw_fill(&stream);
		raw_publish(&stream);
		sleep_ms(10);
		__atomic_store_n(&neighbour.reports, __atomic_load_n(&stream.control->feedback_count, __ATOMIC_ACQUIRE),
						 __ATOMIC_RELEASE);
	}
	raw_stream_finish(&stream);
	close(fd);
	free(reply);
	return NULL;
}

/* Reports keep coming. */
static void check_neighbour(void)
{
	const uint64_t before = __atomic_load_n(&neighbour.reports, __ATOMIC_ACQUIRE);
	for (unsigned waited = 0; waited < PATIENCE_MS; waited += 5) {
		if (neighbour.failed || __atomic_load_n(&neighbour.reports, __ATOMIC_ACQUIRE) > before + 2)
			break;
		sleep_ms(5);
	}
	CHECK(!neighbour.failed);
	CHECK(__atomic_load_n(&neighbour.reports, __ATOMIC_ACQUIRE) > before + 2);
}

/* ---- refusals ---- */

static void check_refused(int fd, uint32_t code, bool fatal, const char *field, uint64_t value)
{
	struct raw_reply reply;
	CHECK(raw_receive(fd, &reply));
	CHECK_INT(reply.header.type, PURSUIT_MESSAGE_REFUSED);
	CHECK_INT(reply.bytes, sizeof(reply.refused));
	if (reply.header.type != PURSUIT_MESSAGE_REFUSED)
		return;
	CHECK_INT(reply.refused.code, code);
	CHECK_INT(reply.refused.fatal, fatal);
	CHECK_STRING(reply.refused.field, field);
	CHECK_INT(reply.refused.value, value);
	CHECK(reply.refused.text[0] != 0);
	if (fatal)
		CHECK(raw_is_gone(fd));
}

/* One packet on a fresh connection that is answered with a fatal refusal. */
static void refused_packet(bool greeted, const void *bytes, size_t size, uint32_t code, const char *field,
						   uint64_t value)
{
	const int fd = greeted ? raw_greet(fixture.socket) : raw_connect(fixture.socket);
	CHECK_INT(raw_send(fd, bytes, size, NULL, 0), 0);
	check_refused(fd, code, true, field, value);
	close(fd);
}

static void refused_hello(struct pursuit_message_hello hello, uint32_t code, const char *field, uint64_t value)
{
	refused_packet(false, &hello, sizeof(hello), code, field, value);
}

static void test_hello(void)
{
	struct pursuit_message_hello hello = raw_hello();
	hello.version_min = hello.version_max = 7;
	refused_hello(hello, PURSUIT_REFUSED_VERSION, "version_min", 7);
	hello.version_min = hello.version_max = 0;
	refused_hello(hello, PURSUIT_REFUSED_VERSION, "version_max", 0);
	hello = raw_hello();
	hello.magic = 0x12345678;
	refused_hello(hello, PURSUIT_REFUSED_MESSAGE, "magic", 0x12345678);
	hello = raw_hello();
	hello.reserved = 5;
	refused_hello(hello, PURSUIT_REFUSED_MESSAGE, "reserved", 5);
	hello = raw_hello();
	hello.header.reserved = 6;
	refused_hello(hello, PURSUIT_REFUSED_MESSAGE, "reserved", 6);
	hello = raw_hello();
	memset(hello.name, 'x', sizeof(hello.name));
	refused_hello(hello, PURSUIT_REFUSED_MESSAGE, "name", 64);
	hello = raw_hello();
	refused_packet(true, &hello, sizeof(hello), PURSUIT_REFUSED_MESSAGE, "type", PURSUIT_MESSAGE_HELLO);
}

static void test_packets(void)
{
	static uint8_t large[PURSUIT_WIRE_MAX_PACKET + 5000];
	struct pursuit_message_hello hello = raw_hello();
	struct pursuit_message header = {.type = 77, .size = sizeof(header)};
	refused_packet(false, &hello, 9, PURSUIT_REFUSED_MESSAGE, "size", 9);
	refused_packet(false, &hello, sizeof(hello) - 4, PURSUIT_REFUSED_MESSAGE, "size", sizeof(hello));
	hello.header.size = 80;
	refused_packet(false, &hello, 80, PURSUIT_REFUSED_MESSAGE, "size", 80);
	refused_packet(true, &header, sizeof(header), PURSUIT_REFUSED_MESSAGE, "type", 77);
	header.type = PURSUIT_MESSAGE_WELCOME;
	refused_packet(true, &header, sizeof(header), PURSUIT_REFUSED_MESSAGE, "type", PURSUIT_MESSAGE_WELCOME);
	memcpy(large, &header, sizeof(header));
	refused_packet(true, large, sizeof(large), PURSUIT_REFUSED_MESSAGE, "size", PURSUIT_WIRE_MAX_PACKET + 1);
	const struct pursuit_message_open_stream open = raw_open(1, 4, 4096);
	refused_packet(false, &open, sizeof(open), PURSUIT_REFUSED_MESSAGE, "type", PURSUIT_MESSAGE_OPEN_STREAM);
	refused_packet(true, &open, sizeof(open), PURSUIT_REFUSED_MESSAGE, "fds", 0);
	struct pursuit_message_close_stream close_stream = {
		.header = {.type = PURSUIT_MESSAGE_CLOSE_STREAM, .size = sizeof(close_stream)}, .stream_id = 1, .reserved = 9};
	refused_packet(true, &close_stream, sizeof(close_stream), PURSUIT_REFUSED_MESSAGE, "reserved", 9);
}

static void test_fds(void)
{
	int fds[40];
	const struct pursuit_message_hello hello = raw_hello();
	const struct pursuit_message_open_stream open = raw_open(1, RAW_SLOTS, RAW_SLOT_BYTES);
	for (int i = 0; i < 40; i++)
		fds[i] = raw_memfd(4096, RAW_ALL_SEALS);
	static const int counts[] = {1, 3, 8, 40};
	for (size_t i = 0; i < 4; i++) {
		int fd = raw_connect(fixture.socket);
		CHECK_INT(raw_send(fd, &hello, sizeof(hello), fds, counts[i]), 0);
		check_refused(fd, PURSUIT_REFUSED_MESSAGE, true, "fds", counts[i] == 40 ? 8 : (uint64_t)counts[i]);
		close(fd);
		fd = raw_greet(fixture.socket);
		CHECK_INT(raw_send(fd, &open, sizeof(open), fds, counts[i]), 0);
		check_refused(fd, PURSUIT_REFUSED_MESSAGE, true, "fds", counts[i] == 40 ? 8 : (uint64_t)counts[i]);
		close(fd);
	}
	for (int i = 0; i < 40; i++)
		close(fds[i]);
}

/* OPEN_STREAM that is refused, and the connection lives on. */
static void refused_open(struct pursuit_message_open_stream open, int control_fd, int planes_fd, uint32_t code,
						 const char *field, uint64_t value)
{
	struct raw_reply reply;
	const int fds[2] = {control_fd, planes_fd};
	const int fd = raw_greet(fixture.socket);
	CHECK_INT(raw_send(fd, &open, sizeof(open), fds, 2), 0);
	check_refused(fd, code, false, field, value);
	CHECK_INT(raw_control(fd, "ping", -1, &reply), 0);
	close(fd);
}

static void test_memory(void)
{
	const struct pursuit_message_open_stream message = raw_open(1, RAW_SLOTS, RAW_SLOT_BYTES);
	const uint64_t control_bytes = sizeof(struct pursuit_shm_control), planes_bytes = RAW_SLOTS * RAW_SLOT_BYTES;
	const int control = raw_memfd(control_bytes, RAW_ALL_SEALS), planes = raw_memfd(planes_bytes, RAW_ALL_SEALS);
	const int unsealed = raw_memfd(planes_bytes, 0);
	const int half_sealed = raw_memfd(planes_bytes, F_SEAL_SEAL | F_SEAL_SHRINK);
	const int read_only = raw_memfd(control_bytes, RAW_ALL_SEALS | F_SEAL_WRITE);
	const int small = raw_memfd(4096, RAW_ALL_SEALS), short_planes = raw_memfd(planes_bytes - 1, RAW_ALL_SEALS);
	const int huge = memfd_create("huge", MFD_CLOEXEC | MFD_ALLOW_SEALING | MFD_HUGETLB);
	const int folder = open("/tmp", O_RDONLY | O_CLOEXEC);

	refused_open(message, unsealed, planes, PURSUIT_REFUSED_MEMORY, "control.seals", 0);
	refused_open(message, control, unsealed, PURSUIT_REFUSED_MEMORY, "planes.seals", 0);
	refused_open(message, control, half_sealed, PURSUIT_REFUSED_MEMORY, "planes.seals", F_SEAL_SEAL | F_SEAL_SHRINK);
	refused_open(message, small, planes, PURSUIT_REFUSED_MEMORY, "control.size", 4096);
	refused_open(message, control, short_planes, PURSUIT_REFUSED_MEMORY, "planes.size", planes_bytes - 1);
	refused_open(message, folder, planes, PURSUIT_REFUSED_MEMORY, "control", EINVAL);
	refused_open(message, read_only, planes, PURSUIT_REFUSED_MEMORY, "control", EPERM);
	if (huge >= 0 && fcntl(huge, F_ADD_SEALS, RAW_ALL_SEALS) == 0)
		refused_open(message, control, huge, PURSUIT_REFUSED_MEMORY, "planes", 0x958458f6);
	/* Memory that nobody has written: the control page has no magic. */
	refused_open(message, control, planes, PURSUIT_REFUSED_VALUE, "control.magic", 0);
	const int all[] = {control, planes, unsealed, half_sealed, read_only, small, short_planes, huge, folder};
	for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++)
		close(all[i]);
}

static void test_stream_values(void)
{
	struct raw_stream stream;
	struct pursuit_message_open_stream open = raw_open(0, RAW_SLOTS, RAW_SLOT_BYTES);
	raw_stream_init(&stream, -1, 1);
	refused_open(open, stream.control_fd, stream.planes_fd, PURSUIT_REFUSED_VALUE, "stream_id", 0);
	static const uint32_t slots[] = {0, 2, 9, 0x80000000};
	for (size_t i = 0; i < 4; i++)
		refused_open(raw_open(1, slots[i], RAW_SLOT_BYTES), stream.control_fd, stream.planes_fd, PURSUIT_REFUSED_VALUE,
					 "slot_count", slots[i]);
	static const uint64_t bytes[] = {0, 4097, UINT64_MAX};
	for (size_t i = 0; i < 3; i++)
		refused_open(raw_open(1, RAW_SLOTS, bytes[i]), stream.control_fd, stream.planes_fd, PURSUIT_REFUSED_VALUE,
					 "slot_bytes", bytes[i]);
	refused_open(raw_open(1, RAW_SLOTS, UINT64_C(1) << 40), stream.control_fd, stream.planes_fd, PURSUIT_REFUSED_LIMIT,
				 "slot_bytes", UINT64_C(1) << 40);
	refused_open(raw_open(1, RAW_SLOTS, RAW_SLOT_BYTES - 4096), stream.control_fd, stream.planes_fd,
				 PURSUIT_REFUSED_VALUE, "control.slot_bytes", RAW_SLOT_BYTES);
	refused_open(raw_open(1, RAW_SLOTS - 1, RAW_SLOT_BYTES), stream.control_fd, stream.planes_fd, PURSUIT_REFUSED_VALUE,
				 "control.slot_count", RAW_SLOTS);
	stream.control->version = 2;
	open.stream_id = 1;
	refused_open(open, stream.control_fd, stream.planes_fd, PURSUIT_REFUSED_VALUE, "control.version", 2);
	raw_stream_finish(&stream);
	open.flags = 3;
	const int fd = raw_greet(fixture.socket), fds[2] = {fd, fd};
	CHECK_INT(raw_send(fd, &open, sizeof(open), fds, 2), 0);
	check_refused(fd, PURSUIT_REFUSED_MESSAGE, true, "flags", 3);
	close(fd);
}

static void test_stream_ids(void)
{
	struct raw_stream streams[6];
	struct raw_reply reply;
	const int fd = raw_greet(fixture.socket);
	for (uint64_t i = 0; i < 4; i++) {
		raw_stream_init(&streams[i], fd, 100 + i);
		CHECK(raw_stream_open(&streams[i], &reply));
		CHECK_INT(reply.opened.refresh_numerator, 120);
	}
	raw_stream_init(&streams[4], fd, 101);
	CHECK(!raw_stream_open(&streams[4], &reply));
	CHECK_INT(reply.refused.code, PURSUIT_REFUSED_IN_USE);
	CHECK_INT(reply.refused.value, 101);
	raw_stream_init(&streams[5], fd, 200);
	CHECK(!raw_stream_open(&streams[5], &reply));
	CHECK_INT(reply.refused.code, PURSUIT_REFUSED_LIMIT);
	struct pursuit_message_close_stream message = {
		.header = {.type = PURSUIT_MESSAGE_CLOSE_STREAM, .size = sizeof(message), .serial = 5}, .stream_id = 101};
	CHECK_INT(raw_send(fd, &message, sizeof(message), NULL, 0), 0);
	CHECK(raw_receive(fd, &reply));
	CHECK_INT(reply.header.type, PURSUIT_MESSAGE_STREAM_CLOSED);
	CHECK_INT(reply.header.serial, 5);
	CHECK_INT(reply.closed.stream_id, 101);
	CHECK_INT(raw_send(fd, &message, sizeof(message), NULL, 0), 0);
	check_refused(fd, PURSUIT_REFUSED_VALUE, false, "stream_id", 101);
	CHECK(raw_stream_open(&streams[4], &reply)); /* free again */
	for (uint32_t i = 0; i < 6; i++)
		raw_stream_finish(&streams[i]);
	close(fd);
}

/* ---- frames ---- */

/* The report about this frame; reports about earlier ones are passed over. */
static uint32_t state_of(struct raw_stream *stream, uint64_t frame_id)
{
	struct pursuit_feedback report = {0};
	while (raw_feedback(stream, &report))
		if (report.frame_id == frame_id)
			return report.state;
	return 0;
}

/* Spoils one field, publishes, and expects the refusal; then a good frame is shown. */
static void refused_frame(void (*spoil)(struct pursuit_frame_header *header), const char *field, uint64_t value)
{
	struct raw_stream stream;
	struct raw_reply reply;
	const int fd = raw_greet(fixture.socket);
	raw_stream_init(&stream, fd, 9);
	CHECK(raw_stream_open(&stream, &reply));
	struct pursuit_frame_header *header = raw_fill(&stream);
	spoil(header);
	const uint64_t id = header->frame_id;
	raw_publish(&stream);
	CHECK(raw_receive(fd, &reply));
	CHECK_INT(reply.header.type, PURSUIT_MESSAGE_REFUSED);
	CHECK_INT(reply.refused.code, PURSUIT_REFUSED_FRAME);
	CHECK_INT(reply.refused.fatal, 0);
	CHECK_INT(reply.refused.stream_id, 9);
	CHECK_STRING(reply.refused.field, field);
	CHECK_INT(reply.refused.value, value);
	CHECK_INT(state_of(&stream, id), PURSUIT_FEEDBACK_REFUSED);
	raw_fill(&stream);
	raw_publish(&stream);
	CHECK_INT(state_of(&stream, stream.next_id - 1), PURSUIT_FEEDBACK_SHOWN);
	raw_stream_finish(&stream);
	close(fd);
}

static void spoil_width(struct pursuit_frame_header *h)
{
	h->planes[0].width = 0;
}
static void spoil_height(struct pursuit_frame_header *h)
{
	h->planes[2].height = 16385;
}
static void spoil_format(struct pursuit_frame_header *h)
{
	h->planes[0].format = 99;
}
static void spoil_stride(struct pursuit_frame_header *h)
{
	h->planes[1].stride = 4;
}
static void spoil_offset(struct pursuit_frame_header *h)
{
	h->planes[1].offset = UINT64_MAX - 63;
}
static void spoil_id(struct pursuit_frame_header *h)
{
	h->frame_id = 0;
}
static void spoil_count(struct pursuit_frame_header *h)
{
	h->plane_count = 9;
}
static void spoil_near(struct pursuit_frame_header *h)
{
	h->near_distance = NAN;
}
static void spoil_reserved(struct pursuit_frame_header *h)
{
	h->reserved[100] = 4;
}

static uint64_t bits_of(float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof(bits));
	return bits;
}

static void test_frame_headers(void)
{
	refused_frame(spoil_width, "planes[0].width", 0);
	refused_frame(spoil_height, "planes[2].height", 16385);
	refused_frame(spoil_format, "planes[0].format", 99);
	refused_frame(spoil_stride, "planes[1].stride", 4);
	refused_frame(spoil_offset, "planes[1].offset", UINT64_MAX - 63);
	refused_frame(spoil_id, "frame_id", 0);
	refused_frame(spoil_count, "plane_count", 9);
	refused_frame(spoil_near, "near_distance", bits_of(NAN));
	refused_frame(spoil_reserved, "reserved", 4);
}

static void test_garbage_slots(void)
{
	static const uint32_t words[] = {RAW_SLOTS | PURSUIT_SLOT_FRESH, 0 | PURSUIT_SLOT_FRESH, 0xffffffff,
									 0x100 | PURSUIT_SLOT_FRESH};
	for (size_t i = 0; i < 4; i++) {
		const uint64_t one = 1;
		struct raw_stream stream;
		struct raw_reply reply;
		const int fd = raw_greet(fixture.socket);
		raw_stream_init(&stream, fd, 3);
		CHECK(raw_stream_open(&stream, &reply));
		__atomic_store_n(&stream.control->latest, words[i], __ATOMIC_RELEASE);
		CHECK_INT(write(stream.wake_fd, &one, sizeof(one)), 8);
		check_refused(fd, PURSUIT_REFUSED_VALUE, false, "control.latest", words[i]);
		CHECK(raw_receive(fd, &reply));
		CHECK_INT(reply.header.type, PURSUIT_MESSAGE_STREAM_CLOSED);
		CHECK_INT(raw_control(fd, "ping", -1, &reply), 0);
		raw_stream_finish(&stream);
		close(fd);
	}
}

/* Not numbers, or absurd ones: each frame is shown all the same. */
static void test_wild_planes(void)
{
	static const float wild[] = {NAN, INFINITY, -INFINITY, 1e6f, -1e6f, 1e38f, 1e-42f};
	struct raw_stream stream;
	struct raw_reply reply;
	const int fd = raw_greet(fixture.socket);
	raw_stream_init(&stream, fd, 4);
	CHECK(raw_stream_open(&stream, &reply));
	for (size_t i = 0; i < sizeof(wild) / sizeof(wild[0]); i++) {
		struct pursuit_frame_header *header = raw_fill(&stream);
		for (uint32_t j = 0; j < RAW_WIDTH * RAW_HEIGHT; j += i % 2 ? 1 : 7) {
			raw_motion(&stream)[2 * j] = wild[i];
			raw_motion(&stream)[2 * j + 1] = wild[(i + 1) % 7];
			raw_depth(&stream)[j] = wild[(i + 2) % 7];
		}
		header->flags |= PURSUIT_FRAME_MATRICES | PURSUIT_FRAME_JITTER;
		header->view_projection[3] = wild[i];
		header->jitter_x = wild[i];
		header->time_ns = i == 3 ? UINT64_MAX : i == 4 ? 1 : header->time_ns;
		raw_publish(&stream);
		CHECK_INT(state_of(&stream, stream.next_id - 1), PURSUIT_FEEDBACK_SHOWN);
	}
	raw_stream_finish(&stream);
	close(fd);
}

/* ---- the rest ---- */

static void test_client_that_does_not_read(void)
{
	const int fd = raw_greet(fixture.socket);
	const struct pursuit_message_control ping = {.header = {.type = PURSUIT_MESSAGE_CONTROL, .size = sizeof(ping) + 6},
												 .text_bytes = 6};
	uint8_t packet[sizeof(ping) + 6];
	memcpy(packet, &ping, sizeof(ping));
	memcpy(packet + sizeof(ping), "status", 6);
	int result = 0;
	for (int i = 0; i < 100000 && result == 0; i++)
		result = raw_send(fd, packet, sizeof(packet), NULL, 0);
	CHECK(result == -EPIPE || result == -ECONNRESET);
	CHECK(fixture_logged(&fixture, "does not read its socket"));
	close(fd);
}

static void test_control_packets(void)
{
	struct pursuit_message_control control = {.header = {.type = PURSUIT_MESSAGE_CONTROL, .size = sizeof(control)},
											  .text_bytes = 5};
	refused_packet(true, &control, sizeof(control), PURSUIT_REFUSED_MESSAGE, "text_bytes", 5);
	control.text_bytes = 0;
	control.status = 3;
	refused_packet(true, &control, sizeof(control), PURSUIT_REFUSED_MESSAGE, "status", 3);
	control.status = 0;
	control.reserved = 4;
	refused_packet(true, &control, sizeof(control), PURSUIT_REFUSED_MESSAGE, "reserved", 4);
	uint8_t packet[sizeof(control) + 4] = {0};
	control = (struct pursuit_message_control){.header = {.type = PURSUIT_MESSAGE_CONTROL, .size = sizeof(packet)},
											   .text_bytes = 4};
	memcpy(packet, &control, sizeof(control));
	refused_packet(true, packet, sizeof(packet), PURSUIT_REFUSED_MESSAGE, "text", 0);
}

static void test_nothing_leaked(void)
{
	static int at_start;
	if (at_start == 0) {
		at_start = fixture_settled_fds(&fixture);
		return;
	}
	CHECK(fixture_fds_become(&fixture, at_start));
}

static void test_garbage_packets(void)
{
	uint32_t random = 12345;
	for (int i = 0; i < 300; i++) {
		uint8_t packet[256];
		const int fd = i % 2 ? raw_greet(fixture.socket) : raw_connect(fixture.socket);
		for (size_t j = 0; j < sizeof(packet); j++)
			packet[j] = (uint8_t)((random = random * 1664525u + 1013904223u) >> 24);
		const uint32_t type = 1 + random % 9, size = 1 + (random >> 8) % 256;
		if (i % 3)
			memcpy(packet, (uint32_t[]){type, size}, 8);
		CHECK_INT(raw_send(fd, packet, size, NULL, 0), 0);
		CHECK(raw_is_gone(fd));
		close(fd);
	}
}

static void test_too_many_clients(void)
{
	int fds[40];
	struct raw_reply reply;
	bool refused = false;
	for (int i = 0; i < 20; i++)
		fds[i] = raw_greet(fixture.socket);
	for (int i = 0; i < 20; i++)
		refused = refused || fds[i] < 0;
	CHECK(refused); /* 16 is the default */
	const int fd = raw_connect(fixture.socket);
	CHECK(raw_receive(fd, &reply));
	CHECK_INT(reply.refused.code, PURSUIT_REFUSED_LIMIT);
	CHECK_STRING(reply.refused.field, "clients");
	close(fd);
	for (int i = 0; i < 20; i++)
		if (fds[i] >= 0)
			close(fds[i]);
}

static void with_neighbour(void (*test)(void))
{
	test();
	check_neighbour();
}

int main(int argc, char **argv)
{
	static const struct {
		const char *name;
		void (*run)(void);
	} tests[] = {
		{"nothing leaked", test_nothing_leaked},
		{"hello", test_hello},
		{"packets", test_packets},
		{"fds", test_fds},
		{"memory", test_memory},
		{"stream values", test_stream_values},
		{"stream ids", test_stream_ids},
		{"frame headers", test_frame_headers},
		{"garbage slots", test_garbage_slots},
		{"wild planes", test_wild_planes},
		{"control packets", test_control_packets},
		{"garbage packets", test_garbage_packets},
		{"client that does not read", test_client_that_does_not_read},
		{"too many clients", test_too_many_clients},
		{"nothing leaked", test_nothing_leaked},
	};
	static const char *const arguments[] = {"--method", "grid", NULL};
	if (argc < 2)
		return 2;
	signal(SIGPIPE, SIG_IGN);
	fixture_init(&fixture, argv[1]);
	fixture_start(&fixture, arguments);
	pthread_create(&neighbour.thread, NULL, be_served, NULL);
	check_neighbour();
	for (size_t i = 0; i < sizeof(tests) / sizeof(tests[0]); i++) {
		const int before = test_failed();
		with_neighbour(tests[i].run);
		printf("%s %s\n", test_failed() == before ? "ok    " : "FAILED", tests[i].name);
		fflush(stdout);
	}
	neighbour.stop = true;
	pthread_join(neighbour.thread, NULL);
	CHECK_INT(fixture_stop(&fixture, SIGTERM), 0);
	fixture_finish(&fixture);
	return test_result();
}
