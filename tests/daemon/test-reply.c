/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Answers to CONTROL requests: whole, whatever their length, or an error; never a part. */

#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <unistd.h>

#include "daemon/server.h"
#include "tests/daemon/fixture.h"
#include "tests/daemon/raw-client.h"
#include "tests/fuzz/fake-output.h"

#define MOST (PURSUIT_WIRE_MAX_PACKET - sizeof(struct pursuit_message_control))

static struct server *server;
static atomic_bool stop;

/* "12": twelve letters. */
static void answer(void *data, uint64_t client_id, uint32_t serial, const char *text, int fd)
{
	const size_t length = strtoul(text, NULL, 10);
	char *letters = malloc(length + 1);
	(void)data;
	(void)fd;
	memset(letters, 'x', length);
	letters[length] = 0;
	server_reply(server, client_id, serial, 0, letters);
	free(letters);
}

static void *run(void *data)
{
	struct error error;
	while (!atomic_load(&stop))
		loop_step(data, 10, &error);
	return NULL;
}

static void check_lengths(int fd)
{
	static const size_t lengths[] = {0, 1, 1000, MOST - 1, MOST, MOST + 1, 3 * MOST};
	static struct raw_reply reply;
	for (size_t i = 0; i < sizeof(lengths) / sizeof(lengths[0]); i++) {
		char request[32], sentence[64];
		const char *text = (const char *)reply.raw + sizeof(reply.control);
		const bool fits = lengths[i] <= MOST;
		snprintf(request, sizeof(request), "%zu", lengths[i]);
		snprintf(sentence, sizeof(sentence), "the answer has %zu bytes", lengths[i]);
		CHECK_INT(raw_control(fd, request, -1, &reply), fits ? 0 : EMSGSIZE);
		if (fits)
			CHECK_INT(strlen(text), lengths[i]);
		else
			CHECK(strstr(text, sentence) != NULL);
	}
}

static void test_never_cut(void)
{
	struct settings settings;
	struct clock clock;
	struct log log;
	struct error error = {""};
	pthread_t thread;
	char folder[] = "/tmp/pursuit-reply-XXXXXX";
	CHECK(mkdtemp(folder) != NULL);
	settings_defaults(&settings);
	snprintf(settings.socket, sizeof(settings.socket), "%s/socket", folder);
	clock_init_real(&clock);
	log_init(&log, LOG_LEVEL_ERROR);
	struct loop *loop = loop_create(&error);
	struct output *output = fake_output_create(&clock);
	const struct server_params params = {
		.loop = loop, .log = &log, .clock = &clock, .settings = &settings, .output = output, .control = answer};
	server = server_create(&params, &error);
	CHECK(server != NULL);
	pthread_create(&thread, NULL, run, loop);
	const int fd = raw_greet(settings.socket);
	CHECK(fd >= 0);
	check_lengths(fd);
	close(fd);
	atomic_store(&stop, true);
	pthread_join(thread, NULL);
	server_destroy(&server);
	fake_output_destroy(&output);
	loop_destroy(&loop);
	rmdir(folder);
}

int main(void)
{
	RUN(test_never_cut);
	return test_result();
}
