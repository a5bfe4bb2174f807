/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A stream that broke the rules is ended, that one and no other, and its client is told, whatever else is to be told.
 */

#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <unistd.h>

#include "daemon/server.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/raw-client.h"
#include "tests/test.h"

#define STREAM 7u
#define GARBAGE (RAW_SLOTS | PURSUIT_SLOT_FRESH)

/* Main stands still while there is no thread. */
static struct {
	struct settings settings;
	struct clock clock;
	struct log log;
	struct loop *loop;
	struct output *output;
	struct server *server;
	pthread_t thread;
	atomic_bool stop;
	char folder[32];
} house;

static void answer(void *data, uint64_t client_id, uint32_t serial, const char *text, int fd)
{
	server_reply(house.server, client_id, serial, 0, text);
}

static uint32_t keys;

static void on_key(void *data, const struct presenter_key *key)
{
	keys++;
}

static bool was_logged(const char *text)
{
	static char content[4096];
	const ssize_t got = pread(house.log.fd, content, sizeof(content) - 1, 0);
	content[got > 0 ? got : 0] = 0;
	return strstr(content, text) != NULL;
}

static void *run(void *data)
{
	struct error error;
	while (!atomic_load(&house.stop))
		loop_step(house.loop, 10, &error);
	return NULL;
}

static void go_on(void)
{
	atomic_store(&house.stop, false);
	CHECK_INT(pthread_create(&house.thread, NULL, run, NULL), 0);
}

static void stand_still(void)
{
	atomic_store(&house.stop, true);
	pthread_join(house.thread, NULL);
}

static bool start(void)
{
	struct error error = {""};
	snprintf(house.folder, sizeof(house.folder), "/tmp/pursuit-broken-XXXXXX");
	CHECK(mkdtemp(house.folder) != NULL);
	settings_defaults(&house.settings);
	settings_set(&house.settings, "method", "hold", &error);
	settings_set(&house.settings, "present", "headless", &error);
	snprintf(house.settings.socket, sizeof(house.settings.socket), "%s/socket", house.folder);
	clock_init_real(&house.clock);
	log_init(&house.log, LOG_LEVEL_WARNING);
	house.log.fd = memfd_create("log", MFD_CLOEXEC);
	house.loop = loop_create(&error);
	const struct output_params output = {
		.loop = house.loop, .settings = &house.settings, .clock = &house.clock, .log = &house.log};
	house.output = output_create(&output, &error);
	const struct server_params server = {.loop = house.loop,
										 .log = &house.log,
										 .clock = &house.clock,
										 .settings = &house.settings,
										 .output = house.output,
										 .control = answer,
										 .key = on_key};
	house.server = house.output ? server_create(&server, &error) : NULL;
	return house.server != NULL;
}

static void end(void)
{
	server_destroy(&house.server);
	output_destroy(&house.output);
	loop_destroy(&house.loop);
	rmdir(house.folder);
}

/* The render thread has something to tell. */
static void wait_for_event(void)
{
	struct pollfd event = {output_event_fd(house.output), POLLIN, 0};
	CHECK_INT(poll(&event, 1, PATIENCE_MS), 1);
}

/* Main has been told all. */
static void wait_until_heard(void)
{
	struct pollfd event = {output_event_fd(house.output), POLLIN, 0};
	for (int i = 0; i < (int)PATIENCE_MS && poll(&event, 1, 0) == 1; i++)
		usleep(1000);
	CHECK_INT(poll(&event, 1, 0), 0);
}

static void break_stream(struct raw_stream *stream)
{
	__atomic_store_n(&stream->control->latest, GARBAGE, __ATOMIC_RELEASE);
	output_wake(house.output);
}

static uint32_t receive(int fd, struct raw_reply *reply)
{
	CHECK(raw_receive(fd, reply));
	return reply->header.type;
}

/* Main hears that a stream broke only when its client has opened another one with the same id. */
static void test_same_id(void)
{
	const struct pursuit_message_close_stream close_stream = {
		.header = {.type = PURSUIT_MESSAGE_CLOSE_STREAM, .size = sizeof(close_stream), .serial = 5},
		.stream_id = STREAM};
	const struct pursuit_message_open_stream open = raw_open(STREAM, RAW_SLOTS, RAW_SLOT_BYTES);
	struct raw_stream stream, other;
	struct raw_reply reply;

	go_on();
	const int fd = raw_greet(house.settings.socket);
	raw_stream_init(&stream, fd, STREAM);
	raw_stream_init(&other, fd, STREAM);
	CHECK(raw_stream_open(&stream, &reply));
	stand_still();
	const int fds[2] = {other.control_fd, other.planes_fd};
	CHECK_INT(raw_send(fd, &close_stream, sizeof(close_stream), NULL, 0), 0);
	CHECK_INT(raw_send(fd, &open, sizeof(open), fds, 2), 0);
	break_stream(&stream);
	wait_for_event();
	go_on();
	CHECK_INT(receive(fd, &reply), PURSUIT_MESSAGE_STREAM_CLOSED);
	CHECK_INT(reply.header.serial, 5);
	CHECK_INT(receive(fd, &reply), PURSUIT_MESSAGE_STREAM_OPENED);
	other.wake_fd = reply.fds[0];
	wait_until_heard();
	CHECK_INT(raw_control(fd, "ping", -1, &reply), 0);
	raw_stream_finish(&stream);
	raw_stream_finish(&other);
	close(fd);
	stand_still();
}

/* The render thread has looked at what was done to a stream. */
static void wait_for_render(void)
{
	const uint64_t rounds = output_rounds(house.output);
	while (output_rounds(house.output) < rounds + 2) {
		output_wake(house.output);
		usleep(1000);
	}
}

/* Refused frames and the end of a stream are told however many keys wait; keys that are lost are not lost silently. */
static void test_full(void)
{
	const struct presenter_key key = {.code = 1};
	struct raw_stream stream;
	struct raw_reply reply;
	struct pursuit_feedback report;

	go_on();
	const int fd = raw_greet(house.settings.socket);
	raw_stream_init(&stream, fd, STREAM);
	CHECK(raw_stream_open(&stream, &reply));
	stand_still();
	keys = 0;
	for (uint32_t i = 0; i < OUTPUT_KEYS + 3; i++)
		output_press_key(house.output, &key);
	raw_fill(&stream)->plane_count = 99;
	raw_publish(&stream);
	output_wake(house.output);
	CHECK(raw_feedback(&stream, &report));
	CHECK_INT(report.state, PURSUIT_FEEDBACK_REFUSED);
	raw_fill(&stream)->reserved[0] = 7;
	raw_publish(&stream);
	output_wake(house.output);
	CHECK(raw_feedback(&stream, &report));
	CHECK_INT(report.state, PURSUIT_FEEDBACK_REFUSED);
	wait_for_render();
	go_on();
	CHECK_INT(receive(fd, &reply), PURSUIT_MESSAGE_REFUSED);
	CHECK_INT(reply.refused.code, PURSUIT_REFUSED_FRAME);
	CHECK_STRING(reply.refused.field, "reserved");
	CHECK_INT(raw_control(fd, "ping", -1, &reply), 0);
	CHECK_INT(keys, OUTPUT_KEYS);
	CHECK(was_logged("3 keys were pressed while 64 waited, and are lost"));
	stand_still();

	for (uint32_t i = 0; i < OUTPUT_KEYS; i++)
		output_press_key(house.output, &key);
	break_stream(&stream);
	wait_for_render();
	go_on();
	CHECK_INT(receive(fd, &reply), PURSUIT_MESSAGE_REFUSED);
	CHECK_STRING(reply.refused.field, "control.latest");
	CHECK_INT(receive(fd, &reply), PURSUIT_MESSAGE_STREAM_CLOSED);
	CHECK_INT(raw_control(fd, "ping", -1, &reply), 0);
	raw_stream_finish(&stream);
	close(fd);
	stand_still();
}

int main(void)
{
	CHECK(start());
	if (house.server) {
		RUN(test_same_id);
		RUN(test_full);
	}
	end();
	return test_result();
}
